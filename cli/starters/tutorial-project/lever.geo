// A steel lever, in millimeters: 120 mm from the bore of its pivot to the eye, 10 mm thick.
SetFactory("OpenCASCADE");
Box(1) = {0, -8, -5, 120, 16, 10};           // a corner, and the lengths along x, y and z
Cylinder(2) = {0, 0, -10, 0, 0, 20, 16};     // a boss about the pivot
Cylinder(3) = {120, 0, -5, 0, 0, 10, 12};    // and one about the eye
BooleanUnion(4) = { Volume{1}; Delete; }{ Volume{2, 3}; Delete; };
Cylinder(5) = {0, 0, -10, 0, 0, 20, 10};     // the bore
Cylinder(6) = {120, 0, -5, 0, 0, 10, 6};     // the eye
BooleanDifference(7) = { Volume{4}; Delete; }{ Volume{5, 6}; Delete; };

bore() = Surface In BoundingBox {-10.1, -10.1, -10.1, 10.1, 10.1, 10.1};
eye() = Surface In BoundingBox {113.9, -6.1, -5.1, 126.1, 6.1, 5.1};
Physical Surface("bore") = {bore()};
Physical Surface("eye") = {eye()};
Physical Volume("lever") = {7};

Mesh.MeshSizeMax = 7;
Mesh.MeshSizeFromCurvature = 12;
Mesh.ElementOrder = 2;                       // tetrahedra of ten nodes
