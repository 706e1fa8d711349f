"""A robot as the tables of a model file."""

from collections import Counter
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from ..solver.schema.paths import relative
from .bodies import GROUND_NAME, ModelBody, ground, rigid_body
from .couplings import NamedJoint, coupler, motor, servos, spring, stop
from .description import Actuator, Joint, Robot
from .document import Section, tidy
from .errors import RobotError
from .flexible import flexible_body, mass_difference
from .names import Names
from .options import ImportOptions
from .rotors import rotor
from .tree import ON_GROUND, Tree, owners_of, tree_of


@dataclass(frozen=True)
class Conversion:
    """The parts of a model, and what is told of them.

    remarks: what the robot has and the model has not, or has otherwise.
    """

    bodies: Mapping[str, ModelBody]
    joints: Sequence[NamedJoint]
    sections: Sequence[Section]
    remarks: Sequence[str]


def convert(
    robot: Robot,
    options: ImportOptions,
    folder: Path,
    shaped: Callable[[ModelBody, Tree], list[str]],
) -> Conversion:
    """The parts of the model of a robot, for a file in a folder.

    shaped: gives a body its shape, and says what it left out. `RobotError` names the file, and the
    link or joint.
    """
    return _Converter(robot, options, folder, shaped).convert()


@dataclass
class _Converter:
    robot: Robot
    options: ImportOptions
    folder: Path
    shaped: Callable[[ModelBody, Tree], list[str]]
    remarks: list[str] = field(default_factory=list)

    def convert(self) -> Conversion:
        robot, options = self.robot, self.options
        self._check_options()
        starts = self._starts()
        tree = tree_of(robot, starts)
        if options.base == "fixed" and tree.root in options.flexible:
            raise self._error(
                f"flexible: link {tree.root!r} is the root, which stands on the ground"
            )
        owner = owners_of(robot, tree, options.flexible, options.base == "free")
        names = Names([GROUND_NAME])
        bodies = self._bodies(tree, owner, names)
        joints = self._joints(tree, owner, bodies, starts, names)
        joint_sections = [each.section(tree, options.flexible) for each in joints.values()]
        rotors = [
            section
            for each in joints.values()
            if each.joint.armature and each.coordinate
            for section in self._rotor(each, tree, names)
        ]
        self._attach_links(tree, owner, bodies)
        sections = [
            self._simulation(),
            *(
                self._section(body)
                for body in bodies.values()
                if body.name != GROUND_NAME or body.frames
            ),
            *joint_sections,
            *rotors,
            *self._acting(tree, joints, names),
        ]
        counts = Counter([*robot.left_out, *self.remarks])
        remarks = [f"{what} ({n} times)" if n > 1 else what for what, n in counts.items()]
        return Conversion(bodies, list(joints.values()), sections, remarks)

    def _check_options(self) -> None:
        """`RobotError` for links and joints that the options name and the robot has not."""
        robot, options = self.robot, self.options
        for link in options.flexible:
            if link not in robot.links:
                known = ", ".join(robot.links)
                raise self._error(f"flexible: no link {link!r}; there are: {known}")
        moving = {joint.name: joint for joint in robot.joints if joint.coordinate is not None}
        for option, named in (("state", options.state), ("servo_of", options.servos)):
            for name in named:
                if name not in moving:
                    known = ", ".join(moving) or "none"
                    raise self._error(
                        f"{option}: no joint {name!r} with one coordinate; there are: {known}"
                    )
                if moving[name].mimic is not None:
                    raise self._error(f"{option}: joint {name!r} follows another one, by its mimic")

    def _bodies(self, tree: Tree, owner: Mapping[str, str], names: Names) -> dict[str, ModelBody]:
        """The bodies by their first links, in the order of the tree."""
        bodies = {ON_GROUND: ground(tree, owner)}
        for first in dict.fromkeys(owner[link] for link in tree.links):
            if first == ON_GROUND:
                continue
            links = [link for link in tree.links if owner[link] == first]
            name = names.new(first)
            if first in self.options.flexible:
                given = self.options.flexible[first]
                ends = self._ends(tree, owner, first)
                body = flexible_body(self.robot, tree, links, given, ends, name)
                self._remark(mass_difference(self.robot, body))
            else:
                body = rigid_body(self.robot, tree, links, name)
                for line in body.above:
                    if line.startswith("principal"):
                        self._remark(f"link {first!r}: {line}")
                self.remarks += self.shaped(body, tree)
            bodies[first] = body
        if self.options.base == "fixed":
            self._ground_remarks(bodies[ON_GROUND])
        return bodies

    def _ground_remarks(self, body: ModelBody) -> None:
        links = [self.robot.links[link] for link in body.links]
        if shown := [link.name for link in links if link.visuals]:
            self._remark(f"shapes of {', '.join(shown)}: the ground has none")

    def _ends(self, tree: Tree, owner: Mapping[str, str], body: str) -> list[Joint]:
        """The joints that end at a body, the one to its parent first."""
        return [
            joint
            for joint in tree.incoming.values()
            if joint.type != "floating"
            and owner[joint.parent] != owner[joint.child]
            and body in (owner[joint.parent], owner[joint.child])
        ]

    def _joints(
        self,
        tree: Tree,
        owner: Mapping[str, str],
        bodies: Mapping[str, ModelBody],
        starts: Mapping[str, float],
        names: Names,
    ) -> dict[str, NamedJoint]:
        """The joints between bodies, by their names in the robot."""
        joints: dict[str, NamedJoint] = {}
        for joint in tree.incoming.values():
            # Fixed within a body: nothing of the joint is left.
            if owner[joint.parent] == owner[joint.child]:
                continue
            if joint.type == "floating":
                self._remark(f"joint {joint.name!r}: floating: link {joint.child!r} is free")
                continue
            ends = bodies[owner[joint.parent]], bodies[owner[joint.child]]
            start = starts.get(joint.name, joint.reference)
            joints[joint.name] = NamedJoint(joint, names.new(joint.name), *ends, start)
            self._remark_joint(joint)
        return joints

    def _remark_joint(self, joint: Joint) -> None:
        if joint.coordinate is not None:
            return
        for key in ("damping", "friction", "stiffness", "armature", "limits"):
            if getattr(joint, key):
                self._remark(f"joint {joint.name!r}: {key} of a {joint.type} joint")

    def _starts(self) -> dict[str, float]:
        """Where the coordinates of joints start, by their names in the robot."""
        starts: dict[str, float] = {}
        # Leaders first: those that mimic them follow from their starts.
        for joint in self.robot.joints:
            if joint.coordinate is not None and joint.mimic is None:
                starts[joint.name] = self._start(joint)
        known = {joint.name: joint for joint in self.robot.joints}
        for joint in self.robot.joints:
            if joint.mimic is not None:
                starts[joint.name] = self._followed(joint, known, starts)
        return starts

    def _start(self, joint: Joint) -> float:
        """As the user says; else the reference, or the middle of limits that leave it out."""
        if joint.name in self.options.state:
            return self.options.state[joint.name]
        if joint.limits is None or joint.limits[0] <= joint.reference <= joint.limits[1]:
            return joint.reference
        lower, upper = joint.limits
        middle = float(tidy(np.array([0.5 * (lower + upper)]))[0])
        self._remark(
            f"joint {joint.name!r}: {joint.reference:g} is outside of its limits, {lower:g} to "
            f"{upper:g}: it starts at {middle:g}; choose another start by --state"
        )
        return middle

    def _followed(
        self, joint: Joint, known: Mapping[str, Joint], starts: Mapping[str, float]
    ) -> float:
        """Where a joint starts that mimics another one, which may mimic a third one."""
        chain, factor, offset = [joint.name], 1.0, 0.0
        while (mimic := joint.mimic) is not None:
            followed = known.get(mimic.joint)
            if followed is None or followed.coordinate is None:
                raise self._error(
                    f"joint {joint.name!r}: mimic: expected a joint with one coordinate, "
                    f"got {mimic.joint!r}"
                )
            if followed.name in chain:
                raise self._error(f"joints mimic each other: {', '.join(map(repr, chain))}")
            offset += factor * mimic.offset
            factor *= mimic.multiplier
            joint = followed
            chain.append(joint.name)
        return factor * starts[joint.name] + offset

    def _acting(
        self, tree: Tree, joints: Mapping[str, NamedJoint], names: Names
    ) -> Iterator[Section]:
        """Stops, motors and couplers."""
        for each in joints.values():
            if each.joint.limits is not None and each.coordinate:
                yield stop(each, each.joint.limits, self.robot, tree, self.options)
        for actuator in self._actuators(joints):
            joint = joints[actuator.joint]
            # A servo of --servo is called by its joint, whose name is taken.
            name = f"{joint.name} servo" if actuator.name == actuator.joint else actuator.name
            yield motor(actuator, joint, names.new(name), Names().new(actuator.name))
        for each in joints.values():
            if each.joint.stiffness and each.coordinate:
                yield spring(each)
        for each in joints.values():
            if each.joint.mimic is not None:
                yield coupler(each, each.joint.mimic, joints[each.joint.mimic.joint])

    def _rotor(self, joint: NamedJoint, tree: Tree, names: Names) -> Iterator[Section]:
        if joint.parent.superelement is not None:
            self._remark(f"joint {joint.joint.name!r}: armature, on a flexible link")
            return
        yield from rotor(joint, tree, self.options.gear_ratio, names)

    def _actuators(self, joints: Mapping[str, NamedJoint]) -> Iterator[Actuator]:
        yield from self.robot.actuators
        yield from servos(joints.values(), self.options)

    def _attach_links(
        self, tree: Tree, owner: Mapping[str, str], bodies: Mapping[str, ModelBody]
    ) -> None:
        """Links that are fixed to others as frames of the body, by their names."""
        for body in bodies.values():
            # The first link has the axes of the body, and its joint a frame.
            inner = body.links if body.name == GROUND_NAME else body.links[1:]
            for link in inner:
                if body.superelement is None:
                    body.attach(link, tree.pose[link])
                else:
                    self._remark(f"link {link!r} on flexible link {body.links[0]!r}: no frame")

    def _simulation(self) -> Section:
        options = self.options
        values: dict[str, object] = {"t_end": options.t_end}
        remarks = {"t_end": "[s]"}
        # Bodies with a superelement have a step of their own, which is that of the run.
        if not options.flexible:
            values["step"] = options.step
            remarks["step"] = "[s]"
        values["gravity"] = tidy(self.robot.gravity)
        return Section("[simulation]", values, remarks)

    def _section(self, body: ModelBody) -> Section:
        return body.section("" if body.file is None else relative(str(body.file), self.folder))

    def _remark(self, line: str) -> None:
        if line:
            self.remarks.append(line)

    def _error(self, message: str) -> RobotError:
        return RobotError(f"{self.robot.path}: {message}")
