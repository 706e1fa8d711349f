"""The second order of elastic motion, in a few coordinates q.

statics: the fields under loads of interfaces and of rotation, and how much they stiffen a shape;
coordinates: the lowest modes and soft shapes that q stands for; reduced: everything in terms of q.
"""
