# written by stubs.py from the description of scene files
# ruff: noqa
from collections.abc import Mapping, Sequence
from typing import Any, Literal, TypeAlias

import numpy as np

from .numbers import Number
from .parts import Constraint, Element, Quantity
from .scenes import Scene

Scalar: TypeAlias = float | str | Number
Vector: TypeAlias = str | Sequence[Scalar] | np.ndarray[Any, Any]
Table: TypeAlias = Mapping[str, Any]

class Model:
    """A scene that is being built."""

    name: str
    summary: str | None
    gravity: Vector | None
    def __init__(self, name: str = "model", *, gravity: Vector | None = None, summary: str | None = None) -> None: ...
    def variable(
        self, name: str, initial: Any, bounds: Sequence[float], unit: str = "-", *, count: int | None = None
    ) -> Any:
        """A design variable: a number for formulas, or an array of them with ``count`` or several initial values."""
    def define(self, name: str, value: Any) -> Any:
        """A named number or vector, which formulas know by its name."""
    def add(
        self,
        part: Element | Constraint | Quantity | type[Element] | type[Constraint] | type[Quantity],
        name: str,
        **keys: Any,
    ) -> str:
        """Adds a part of one's own: its nodes by ``on`` or ``between``, its parameters by their names."""
    def scenario(self, name: str, **changes: Any) -> str:
        """Circumstances in which the scene is run: what is different there."""
    def text(self) -> str:
        """The scene file."""
    def scene(self) -> Scene:
        """What can be run."""
    def _repr_html_(self) -> str: ...
    def table(
        self,
        name: str,
        /,
        *,
        points: Sequence[Scalar] | None = None,
        values: str | Sequence[Scalar] | None = None,
        file: str | None = None,
        columns: Sequence[int | str] | None = None,
        interpolation: Literal['monotone', 'smooth', 'lines', 'steps'] | None = None,
        extrapolation: Literal['constant', 'linear'] | None = None,
    ) -> str:
        """A function of one number by values at points, which all formulas call by its name: `road(wheel.position.x)`, `drag(v)`. Values may be formulas of design variables. An [[element]], a [[state]] or a functional by a formula may have tables of its own by its key table.

        * ``points`` (list of number or formula, optional): numbers at which it has values, increasing; those of the file
        * ``values`` (text, or list of number or formula, optional): values there; those of the file
        * ``file`` (text, optional): a text file with a line for each point (CSV), beside the scene file; none
        * ``columns`` (list of 2 times whole number, optional): which columns of the file have the points and the values, by the names in its first line or by numbers from 1 on; the first two
        * ``interpolation`` ("monotone" or "smooth" or "lines" or "steps", optional): between points: cubics that stay between neighbouring values, a natural spline, straight lines, or the value of the point before; the first two go on with constant slope outside, the others are constant there; monotone
        * ``extrapolation`` ("constant" or "linear", optional): beyond the points: the value at the end, or straight on with the slope there; a run that gets there warns; linear with monotone and smooth, constant with lines and steps
        """
    def material(
        self,
        name: str,
        /,
        *,
        young: Scalar,
        poisson: Scalar,
        density: Scalar,
    ) -> str:
        """An isotropic elastic material.

        * ``young`` (number or formula): Young's modulus E [N/m2]
        * ``poisson`` (number or formula): Poisson's ratio [-]
        * ``density`` (number or formula): density [kg/m3]
        """
    @property
    def section(self) -> _Section:
        """The section of beams and cables; axis 1 along the line, 2 and 3 across. For beams that taper its numbers may use `share`, the place along the length from 0 to 1: `width = "0.05 - 0.02 * share"`."""
    def laminate(
        self,
        name: str,
        /,
        *,
        plies: Sequence[Table],
        offset: Scalar | None = None,
        shear_factor: Scalar | None = None,
    ) -> str:
        """Plies of a shell, from below.

        * ``plies`` (list of table plies with thickness, angle, young, poisson, shear, density, tension, compression, shear_strength, for): plies
        * ``offset`` (number or formula, optional): of the middle of all plies from the nodes, along the normal; 0 [m]
        * ``shear_factor`` (number or formula, optional): share of the shear stiffness that acts; 5/6 [-]
        """
    def body(
        self,
        name: str,
        /,
        *,
        position: Vector | None = None,
        orientation: Table | None = None,
        velocity: Vector | None = None,
        angular_velocity: Vector | None = None,
        mass: Scalar | None = None,
        mass_centre: Vector | None = None,
        inertia: Sequence[Scalar] | None = None,
        coordinates: Literal['euler_parameters', 'natural'] | None = None,
        solids: Sequence[Table] | None = None,
        draw: Sequence[Vector] | None = None,
    ) -> str:
        """A rigid body: a frame in space, with or without mass. The body named ground is there already; it never moves.

        * ``name`` (text): name, by which others refer to it
        * ``position`` (vector, optional): origin of its frame; that of the world [m]
        * ``orientation`` (table orientation of type angle, x_axis, euler_parameters, optional): its axes; those of the world
        * ``velocity`` (vector, optional): velocity of the origin; 0 [m/s]
        * ``angular_velocity`` (vector, optional): in the world; 0 [rad/s]
        * ``mass`` (number or formula, optional): mass; none [kg]
        * ``mass_centre`` (vector, optional): in its own axes from its origin; the origin [m]
        * ``inertia`` (list of number or formula, optional): xx, yy, zz, and xy, xz, yz if they are not 0, about the mass centre in its own axes; needed with mass [kg m2]
        * ``coordinates`` ("euler_parameters" or "natural", optional): kind of its coordinates; euler_parameters
        * ``solids`` (list of table solids of type box, cylinder, sphere, surface, optional): solids of which it consists, in the world at the start, instead of mass, mass_centre and inertia; none
        * ``draw`` (list of vector, optional): corners of a line of the picture, in the world at the start; none [m]
        """
    def point(
        self,
        name: str,
        /,
        *,
        position: Vector,
        velocity: Vector | None = None,
        mass: Scalar | None = None,
    ) -> str:
        """A point without rotation.

        * ``name`` (text): name, by which others refer to it
        * ``position`` (vector): place [m]
        * ``velocity`` (vector, optional): velocity; 0 [m/s]
        * ``mass`` (number or formula, optional): mass; none [kg]
        """
    def beam(
        self,
        name: str,
        /,
        *,
        from_: Vector,
        to: Vector | None = None,
        elements: int | str,
        start_node: str | None = None,
        end_node: str | None = None,
        clamped: Literal['start', 'end'] | Sequence[Literal['start', 'end']] | None = None,
        motion: Table | None = None,
        section: str,
        second_axis: Vector | None = None,
        arc: Table | None = None,
        twist: Scalar | None = None,
    ) -> str:
        """A beam, geometrically exact, with shear and torsion, of three-node elements.

        * ``name`` (text): name; its nodes are NAME.start, NAME.end and NAME[i], counted from 0
        * ``from_`` (vector): where it starts [m]
        * ``to`` (vector, optional): where it ends; required unless `arc` is given [m]
        * ``elements`` (whole number): equal elements
        * ``start_node`` (text, optional): node that it starts in; its own
        * ``end_node`` (text, optional): node that it ends in; its own
        * ``clamped`` ("start" or "end", or list of "start" or "end", optional): ends that never move; none
        * ``motion`` (table motion with point, velocity, angular_velocity, optional): rigid motion that it starts with; at rest
        * ``section`` (text): name of a section
        * ``second_axis`` (vector, optional): direction that spans the plane of axes 1 and 2 with the line; required unless `arc` is given, whose axis is taken [-]
        * ``arc`` (table arc with centre, axis, angle, optional): part of a circle instead of a straight line
        * ``twist`` (number or formula, optional): turn of the section from start to end; 0 [rad]
        """
    def cable(
        self,
        name: str,
        /,
        *,
        from_: Vector,
        to: Vector | None = None,
        elements: int | str,
        start_node: str | None = None,
        end_node: str | None = None,
        clamped: Literal['start', 'end'] | Sequence[Literal['start', 'end']] | None = None,
        motion: Table | None = None,
        section: str,
        strains: Literal['exact', 'small'] | None = None,
    ) -> str:
        """A cable in absolute nodal coordinates: straight at the start, without torsion.

        * ``name`` (text): name; its nodes are NAME.start, NAME.end and NAME[i], counted from 0
        * ``from_`` (vector): where it starts [m]
        * ``to`` (vector, optional): where it ends; required unless `arc` is given [m]
        * ``elements`` (whole number): equal elements
        * ``start_node`` (text, optional): node that it starts in; its own
        * ``end_node`` (text, optional): node that it ends in; its own
        * ``clamped`` ("start" or "end", or list of "start" or "end", optional): ends that never move; none
        * ``motion`` (table motion with point, velocity, angular_velocity, optional): rigid motion that it starts with; at rest
        * ``section`` (text): name of a section that is not of type beam
        * ``strains`` ("exact" or "small", optional): strains of its energy; exact
        """
    @property
    def shell(self) -> _Shell:
        """A shell of nine-node elements on a grid: nodes NAME[i, j] with i along the first direction from 0 to twice the elements, j along the second; edges NAME.first_start, NAME.first_end, NAME.second_start, NAME.second_end, and their nodes NAME.first_start[i]."""
    @property
    def mesh(self) -> _Mesh:
        """A shell on a mesh of quadrilaterals of four, eight and nine nodes and triangles of six. Node NAME[i] is the one with the number i of the file of Gmsh, or the i-th of the points from 0 on; NAME.SET are the nodes of a node set, which a physical curve or point is, or of a group of faces, NAME.SET[i] is one of them, counted from 0; NAME.GROUP are the elements of a group, which a physical surface is."""
    @property
    def thin_walls(self) -> _ThinWalls:
        """A member of thin walls of shells along a line; nodes of its ends are NAME.start, NAME.end, and NAME.start[i] one of them."""
    def sphere(
        self,
        name: str,
        /,
        *,
        centre: Vector | None = None,
        radius: Scalar,
        elements: int | str,
        material: str,
        thickness: Scalar,
    ) -> str:
        """A closed sphere of shells, of six faces.

        * ``name`` (text): name, by which others refer to it
        * ``centre`` (vector, optional): centre; the origin [m]
        * ``radius`` (number or formula): radius [m]
        * ``elements`` (whole number): elements along each edge of a face
        * ``material`` (text): name of a material
        * ``thickness`` (number or formula): thickness [m]
        """
    def group(
        self,
        name: str,
        /,
        *,
        of: str,
        first: Sequence[int | str] | None = None,
        second: Sequence[int | str] | None = None,
    ) -> str:
        """Elements of shells by their places in the grid, for functionals.

        * ``name`` (text): name, by which others refer to it
        * ``of`` (text): name of a shell
        * ``first`` (list of 2 times whole number, optional): first and last element along the first direction, from 0; all
        * ``second`` (list of 2 times whole number, optional): first and last element along the second direction, from 0; all
        """
    def coordinate(
        self,
        name: str,
        /,
        *,
        initial: Scalar | None = None,
        rate: Scalar | None = None,
    ) -> str:
        """A number that moves, with the meaning that springs and parts of one's own on it give it; one of them must have inertia.

        * ``name`` (text): name, by which others refer to it
        * ``initial`` (number or formula, optional): value at the start; 0
        * ``rate`` (number or formula, optional): its rate there; 0 [1/s]
        """
    def joint_angle(
        self,
        name: str,
        /,
        *,
        between: Sequence[str],
        axis: Vector,
    ) -> str:
        """A coordinate that counts the angle of b against a over any number of turns, for gears, springs and functionals; a joint must hold the axis.

        * ``name`` (text): name, by which others refer to it
        * ``between`` (list of 2 times text): both nodes, a and b
        * ``axis`` (vector): axis in the world at the start, of any length [-]
        """
    @property
    def state(self) -> _State:
        """States z of first order, z' = f(z, nodes, t), as of a controller, an actuator, the slip of a tyre, inflow. Formulas know nodes as those of an [[element]] do; where a state is a node c of others, their formulas know c.NAME of its values and of its outputs."""
    def number(
        self,
        name: str,
        /,
        *,
        initial: Scalar | None = None,
    ) -> str:
        """A number that only events change: a mode, a counter, a speed that is kept in mind. Formulas know a number c among their nodes as c.value.

        * ``name`` (text): name, by which others refer to it
        * ``initial`` (number or formula, optional): value at the start; 0
        """
    @property
    def joint(self) -> _Joint:
        """What holds nodes together. Geometry is given in the world at the start."""
    def rigid_interface(
        self,
        name: str,
        /,
        *,
        body: str,
        nodes: Sequence[str],
    ) -> str:
        """Nodes that a body carries along as they stand, by a rigid link to each.

        * ``name`` (text): name, by which others refer to it
        * ``body`` (text): the body, or one of the nodes
        * ``nodes`` (list of text): nodes, edges of shells, ends of walls, node sets of meshes
        """
    def hold(
        self,
        *,
        nodes: Sequence[str],
        directions: Literal['x', 'y', 'z', 'rotation_x', 'rotation_y', 'rotation_z'] | Sequence[Literal['x', 'y', 'z', 'rotation_x', 'rotation_y', 'rotation_z']] | None = None,
    ) -> str:
        """Nodes that are held where they stand while the equilibrium is found at which the motion begins (`start` of `[settings]`), and let go then.

        * ``nodes`` (list of text): what is held
        * ``directions`` ("x" or "y" or "z" or "rotation_x" or "rotation_y" or "rotation_z", or list of "x" or "y" or "z" or "rotation_x" or "rotation_y" or "rotation_z", optional): in which directions of the world; all that it has
        """
    def spin(
        self,
        *,
        parts: str | Sequence[str],
        point: Vector | None = None,
        axis: Vector,
        rate: Scalar,
    ) -> str:
        """Parts that turn steadily about an axis of the world where the motion begins (`start = "steady"` of `[settings]`): it begins at the equilibrium in the frame that turns with them. Weights of what turns count with their part along the axis, the mean over a turn.

        * ``parts`` (text, or list of text): bodies, points and members that turn, with all their nodes
        * ``point`` (vector, optional): a point of the axis; the origin [m]
        * ``axis`` (vector): its direction [-]
        * ``rate`` (number or formula): of the turn about it [rad/s]
        """
    def tie(
        self,
        name: str,
        /,
        *,
        nodes: Sequence[str],
        to: str | Sequence[str],
        within: Scalar | None = None,
    ) -> str:
        """Edges of shells, or other nodes, that follow the faces of shells on which they lie, where nodes do not meet: edges in the mean along them, so that constant stresses pass exactly; other nodes where they stand.

        * ``name`` (text): name, by which others refer to it
        * ``nodes`` (list of text): what follows: edges of shells, ends of walls, node sets of meshes, nodes; the more finely divided or the shorter side
        * ``to`` (text, or list of text): shells, meshes and walls whose faces they follow
        * ``within`` (number or formula, optional): how far from the faces they may lie: they keep that distance; a millionth of the diagonal of all of them [m]
        """
    @property
    def driver(self) -> _Driver:
        """A prescribed motion."""
    @property
    def spring(self) -> _Spring:
        """A spring."""
    @property
    def damper(self) -> _Damper:
        """A damper."""
    def element(
        self,
        name: str,
        /,
        *,
        nodes: Table,
        define: Table | None = None,
        table: Table | None = None,
        kinetic: Scalar | None = None,
        potential: Scalar | None = None,
        force: Table | None = None,
        moment: Table | None = None,
        breakpoints: Sequence[Scalar] | None = None,
    ) -> str:
        """A part of one's own, by formulas of what its nodes do. Of a node called a in `nodes` these know a.position and a.velocity [m, m/s], of one with axes a.x_axis, a.y_axis, a.z_axis and a.angular_velocity [rad/s], all in the world; of a joint angle a.value and a.rate, of a state a.NAME of its values and outputs; and the time t.

        * ``name`` (text): name, by which others refer to it
        * ``nodes`` (table): nodes, or points of them, by the names that the formulas give them
        * ``define`` (table, optional): names for formulas that the other formulas here use, later ones those before them; none
        * ``table`` (table, optional): tables that the formulas here call by their names, as those of [table]; none
        * ``kinetic`` (number or formula, optional): kinetic energy, of places and rates; none [J]
        * ``potential`` (number or formula, optional): potential energy, of places; none [J]
        * ``force`` (table, optional): forces on its nodes in the world, of anything; of a joint angle its moment; none [N, N m]
        * ``moment`` (table, optional): moments on bodies among them in the world, of anything; none [N m]
        * ``breakpoints`` (list of number or formula, optional): from the times when jumps and bends of formulas of t were not found from these: not needed, any [s]
        """
    def stop(
        self,
        name: str,
        /,
        *,
        on: str | None = None,
        nodes: Table | None = None,
        define: Table | None = None,
        table: Table | None = None,
        value: Scalar | None = None,
        least: Scalar | None = None,
        most: Scalar | None = None,
        restitution: Scalar | None = None,
        rest_speed: Scalar | None = None,
    ) -> str:
        """A limit of a coordinate, of a joint angle, or of a formula of places: it is hit with an impact under all joints, pushes as long as it would be left, and lets go then. Its reaction is that of a joint of its name.

        * ``name`` (text): name, by which others refer to it
        * ``on`` (text, optional): a coordinate, or the angle of a [[joint_angle]], x; or value with nodes
        * ``nodes`` (table, optional): nodes, or points of them, by the names that value gives them
        * ``define`` (table, optional): names for formulas that the other formulas here use, later ones those before them; none
        * ``table`` (table, optional): tables that the formulas here call by their names, as those of [table]; none
        * ``value`` (number or formula, optional): or x as a formula of places of its nodes and of the time [m, rad]
        * ``least`` (number or formula, optional): least x; none [m, rad]
        * ``most`` (number or formula, optional): largest x; none [m, rad]
        * ``restitution`` (number or formula, optional): e: behind a hit dx/dt is -e times what it was before, from 0, which stays, to 1, which loses nothing; 0 [-]
        * ``rest_speed`` (number or formula, optional): hits with less than this have no restitution: what bounces comes to rest; 0 [m/s, rad/s]
        """
    def friction(
        self,
        name: str,
        /,
        *,
        joint: str,
        sliding: Scalar,
        static: Scalar | None = None,
        preload: Scalar | None = None,
        radius: Scalar | None = None,
    ) -> str:
        """Coulomb friction of a joint, by the force that it carries: its surfaces stick, as long as the static limit holds them, or slip with a force against it.

        * ``name`` (text): name, by which others refer to it
        * ``joint`` (text): name of a revolute, prismatic or point_on_line joint
        * ``sliding`` (number or formula): coefficient of friction where its surfaces slip [-]
        * ``static`` (number or formula, optional): the same where they stick, not below that; sliding [-]
        * ``preload`` (number or formula, optional): force that presses them together beside that of the joint; 0 [N]
        * ``radius`` (number or formula, optional): radius of the bearing of a revolute joint, which needs it [m]
        """
    def clutch(
        self,
        name: str,
        /,
        *,
        between: Sequence[str],
        nodes: Table | None = None,
        define: Table | None = None,
        table: Table | None = None,
        capacity: Scalar,
        static: Scalar | None = None,
    ) -> str:
        """Friction between two coordinates, or of one: a clutch or a brake with a capacity of its own, which slips, or sticks and holds both together.

        * ``name`` (text): name, by which others refer to it
        * ``between`` (list of text): two coordinates whose rates it makes equal, as of a [[joint_angle]]; or one, which it brakes
        * ``nodes`` (table, optional): nodes by the names that the formulas give them, as numbers that events change; none
        * ``define`` (table, optional): names for formulas that the other formulas here use, later ones those before them; none
        * ``table`` (table, optional): tables that the formulas here call by their names, as those of [table]; none
        * ``capacity`` (number or formula): force or moment while it slips, a number or a formula of its nodes and of the time [N, N m]
        * ``static`` (number or formula, optional): the largest that it holds while it sticks, not below that; capacity [N, N m]
        """
    @property
    def shape(self) -> _Shape:
        """What of a node touches others: a contact is between two of them."""
    def contact(
        self,
        name: str,
        /,
        *,
        between: Sequence[str],
        restitution: Scalar | None = None,
        rest_speed: Scalar | None = None,
        sliding: Scalar | None = None,
        static: Scalar | None = None,
        stiffness: Scalar | None = None,
        modulus: Scalar | None = None,
        damping: Scalar | None = None,
        slip_speed: Scalar | None = None,
    ) -> str:
        """Two shapes that hit, push and leave each other. Rigid ones have Coulomb friction: they stick and roll, or slip, and their reaction is that of a joint of the same name. With `stiffness` or `modulus` they give way, and friction is a function of the slip.

        * ``name`` (text): name, by which others refer to it
        * ``between`` (list of 2 times text): two shapes: a plane and another one, or two spheres, of which one may be a point; of those that give way also a sphere and another one, or two capsules
        * ``restitution`` (number or formula, optional): e: behind a hit they part at e times the speed at which they met, from 0, where they stay together, to 1; 0 [-]
        * ``rest_speed`` (number or formula, optional): hits with less than this have no restitution: what bounces comes to rest; 0 [m/s]
        * ``sliding`` (number or formula, optional): coefficient of friction where they slip; no friction [-]
        * ``static`` (number or formula, optional): the same where they stick, not below that; sliding [-]
        * ``stiffness`` (number or formula, optional): k: they give way by the depth d under k d, instead of being rigid [N/m]
        * ``modulus`` (number or formula, optional): E of Hertz's law instead, under 4/3 E sqrt(R) d^(3/2): 1/E is the sum of (1 - nu^2)/E of both, 1/R that of 1/radius [Pa]
        * ``damping`` (number or formula, optional): c of what gives way: its force is 1 + c dd/dt times as large, never below 0; 0 [s/m]
        * ``slip_speed`` (number or formula, optional): s_0 of what gives way, with sliding: friction is |s| / sqrt(|s|^2 + s_0^2) times as large at a slip s, so that all creeps that would stick [m/s]
        """
    def latch(
        self,
        name: str,
        /,
        *,
        on: str | None = None,
        nodes: Table | None = None,
        define: Table | None = None,
        table: Table | None = None,
        value: Scalar | None = None,
        at: Scalar,
        strength: Scalar | None = None,
    ) -> str:
        """What holds a coordinate, a joint angle, or a formula of places once it is reached.

        * ``name`` (text): name, by which others refer to it
        * ``on`` (text, optional): a coordinate, or the angle of a [[joint_angle]], x; or value with nodes
        * ``nodes`` (table, optional): nodes, or points of them, by the names that value gives them
        * ``define`` (table, optional): names for formulas that the other formulas here use, later ones those before them; none
        * ``table`` (table, optional): tables that the formulas here call by their names, as those of [table]; none
        * ``value`` (number or formula, optional): or x as a formula of places of its nodes and of the time [m, rad]
        * ``at`` (number or formula): x that is held once it is reached, with an impact without restitution [m, rad]
        * ``strength`` (number or formula, optional): size of its reaction beyond which it opens for good; none [N, N m]
        """
    def event(
        self,
        name: str,
        /,
        *,
        nodes: Table | None = None,
        define: Table | None = None,
        table: Table | None = None,
        when: Scalar | None = None,
        at: Scalar | None = None,
        direction: Literal['rising', 'falling', 'both'] | None = None,
        once: bool | None = None,
        set: Table | None = None,
        remove: str | Sequence[str] | None = None,
        lock: str | Sequence[str] | None = None,
        end: bool | None = None,
    ) -> str:
        """What happens where a formula passes zero, or at a time. Steps end there, whatever method makes them, and gradients go through the time of it.

        * ``name`` (text): name, by which others refer to it
        * ``nodes`` (table, optional): nodes, or points of them, by the names that the formulas give them; none
        * ``define`` (table, optional): names for formulas that the other formulas here use, later ones those before them; none
        * ``table`` (table, optional): tables that the formulas here call by their names, as those of [table]; none
        * ``when`` (number or formula, optional): what passes zero there, of anything that elements know [any]
        * ``at`` (number or formula, optional): or the time at which it happens [s]
        * ``direction`` ("rising" or "falling" or "both", optional): in which the formula passes zero; both
        * ``once`` (True or False, optional): it happens no second time; false
        * ``set`` (table, optional): new values by names of what formulas know: the value of a number, coordinate or state, the rate of a coordinate, position and velocity of a point or body, angular_velocity of a body, as in { "ball.velocity" = "-e * ball.velocity" }; all from the values before; none [any]
        * ``remove`` (text, or list of text, optional): joints that are removed, as one that breaks; none
        * ``lock`` (text, or list of text, optional): joints that are not there at the start (`present = false`) or were removed, and come with an impact without restitution; none
        * ``end`` (True or False, optional): the run ends there; false
        """
    def force(
        self,
        name: str,
        /,
        *,
        on: str,
        point: Vector | None = None,
        frame: Literal['world', 'body'] | None = None,
        direction: Vector,
        size: float | str | Table,
    ) -> str:
        """A force at a point of a node: direction times size.

        * ``name`` (text): name, by which others refer to it
        * ``on`` (text): node; of an edge, an end or a node set of a mesh each node takes an equal share
        * ``point`` (vector, optional): point of the node, in the world at the start; the node's place [m]
        * ``frame`` ("world" or "body", optional): direction fixed in the world, or turning with the node; world
        * ``direction`` (vector): direction in the world at the start; its length counts [-]
        * ``size`` (number, or text, or table a function of time of type constant, constant_rate, sine, smooth_ramp, step, lines, table, formula): size over time [N]
        """
    def torque(
        self,
        name: str,
        /,
        *,
        on: str,
        frame: Literal['world', 'body'] | None = None,
        axis: Vector,
        size: float | str | Table,
    ) -> str:
        """A torque on a body: axis times size.

        * ``name`` (text): name, by which others refer to it
        * ``on`` (text): node
        * ``frame`` ("world" or "body", optional): direction fixed in the world, or turning with the node; world
        * ``axis`` (vector): axis in the world at the start; its length counts [-]
        * ``size`` (number, or text, or table a function of time of type constant, constant_rate, sine, smooth_ramp, step, lines, table, formula): size over time [N m]
        """
    def distributed_load(
        self,
        name: str,
        /,
        *,
        beam: str,
        frame: Literal['world', 'body'] | None = None,
        direction: Vector,
        size: float | str | Table,
    ) -> str:
        """A force for each length of a beam: direction times size.

        * ``name`` (text): name, by which others refer to it
        * ``beam`` (text): name of a beam
        * ``frame`` ("world" or "body", optional): direction fixed in the world, or turning with the sections; world
        * ``direction`` (vector): direction in the world at the start; its length counts [-]
        * ``size`` (number, or text, or table a function of time of type constant, constant_rate, sine, smooth_ramp, step, lines, table, formula): size over time [N/m]
        """
    def pressure(
        self,
        name: str,
        /,
        *,
        shell: str,
        frame: Literal['world', 'body'] | None = None,
        size: float | str | Table,
    ) -> str:
        """A pressure on a shell; it pushes to where the normal points.

        * ``name`` (text): name, by which others refer to it
        * ``shell`` (text): name of a shell or a mesh, or a group of the faces of one: PLATE.GROUP
        * ``frame`` ("world" or "body", optional): dead load, or normal to the deformed surface; body
        * ``size`` (number, or text, or table a function of time of type constant, constant_rate, sine, smooth_ramp, step, lines, table, formula): size over time [N/m2]
        """
    def drawing(
        self,
        *,
        on: str | None = None,
        points: Sequence[Vector],
    ) -> str:
        """A line of the picture that moves with a node.

        * ``on`` (text, optional): node; ground
        * ``points`` (list of vector): corners in the world at the start [m]
        """
    @property
    def functional(self) -> _Functional:
        """A number that a run gives, with its gradient."""
    def mode(
        self,
        name: str,
        /,
        *,
        number: int | str,
        measure: Literal['frequency', 'growth'] | None = None,
        damped: bool | None = None,
    ) -> str:
        """A number of a mode of small vibrations about the start or the equilibrium, measured by runs, gradients, sweeps and optimizations.

        * ``name`` (text): what results, objective and limits call it
        * ``number`` (whole number): which mode, from 1, as costate modes numbers them: rigid motions and unstable ones count, and those that topple come first
        * ``measure`` ("frequency" or "growth", optional): its omega in rad/s (of one that topples minus its growth), or its growth in 1/s; frequency
        * ``damped`` (True or False, optional): with dampers, states of first order and what else depends on velocities, as about a steady turn always; false
        """
    def measurement(
        self,
        name: str,
        /,
        *,
        functional: str,
        file: str,
        columns: Sequence[int | str] | None = None,
        deviation: Scalar | None = None,
        deviations: str | None = None,
        delay: str | None = None,
    ) -> str:
        """A measured curve to which `costate fit` fits the design variables: the quantity of a functional at given times.

        * ``name`` (text): what results call it
        * ``functional`` (text): name of the functional whose quantity was measured, of a scenario as in "stress [hover]"; what it makes of that over time counts for nothing here
        * ``file`` (text): a text file with a line for each time (CSV), beside the scene file
        * ``columns`` (list of 2 times whole number, optional): which columns of the file have the times and the values, by the names in its first line or by numbers from 1 on; the first two. A unit behind a name, as in `angle [rad]` or `angle (rad)`, must be that of the functional, and may be left out here
        * ``deviation`` (number or formula, optional): standard deviation of the errors of all values; without it and `deviations` errors of all measurements are alike, and their size follows from what the fit leaves [unit]
        * ``deviations`` (text, optional): name of a column with the standard deviation of the error of each value; deviation
        * ``delay`` (text, optional): name of a design variable [s]: what is measured at t is what the motion has at t less this; none
        """
    def settings(
        self,
        *,
        end: Scalar | None = None,
        steps: int | str | None = None,
        method: str | None = None,
        tolerance: Scalar | None = None,
        velocity_tolerance: Scalar | None = None,
        longest_step: Scalar | None = None,
        constraint_level: Literal['position', 'acceleration'] | None = None,
        newton: Literal['round-off', 'residual', 'scaled'] | None = None,
        solver: Literal['automatic', 'dense', 'multifrontal'] | None = None,
        start: Literal['given', 'equilibrium', 'steady'] | None = None,
        locate: bool | None = None,
        divide_steps: bool | None = None,
        drop_redundant: bool | None = None,
        project_start: bool | None = None,
    ) -> str:
        """How a run is made where the command line does not say otherwise.

        * ``end`` (number or formula, optional): duration, or with method static the last load factor; required but for `static`, where it is 1 [s]
        * ``steps`` (whole number, optional): steps of equal size; needed without tolerance
        * ``method`` (text, optional): integrator: esdirk4, generalized-alpha:0.6, variational, static and others, as for --method; esdirk4
        * ``tolerance`` (number or formula, optional): steps are chosen by their error: relative and absolute; steps of equal size [-]
        * ``velocity_tolerance`` (number or formula, optional): the same for velocities; tolerance [-]
        * ``longest_step`` (number or formula, optional): longest step that tolerance may choose; any [s]
        * ``constraint_level`` ("position" or "acceleration", optional): time derivative on which constraints are kept; acceleration
        * ``newton`` ("round-off" or "residual" or "scaled", optional): when Newton's method stops, as for --newton; round-off
        * ``solver`` ("automatic" or "dense" or "multifrontal", optional): solver of the linear systems; automatic
        * ``start`` ("given" or "equilibrium" or "steady", optional): where the motion begins: at the coordinates that the parts give, at the equilibrium near them under the loads of t = 0, or at that in the frame that turns with what `[[spin]]` names; given
        * ``locate`` (True or False, optional): end steps where springs, loads and other elements pass from one piece of their formulas to another: values keep the order of the method, and gradients are exact; true
        * ``divide_steps`` (True or False, optional): halve steps that Newton's method cannot make; false
        * ``drop_redundant`` (True or False, optional): leave out redundant constraint equations instead of refusing them; false
        * ``project_start`` (True or False, optional): project an inconsistent start onto the constraints instead of refusing it: a run prints what was given and what is used; false
        """
    def output(
        self,
        *,
        step: Scalar | None = None,
        histories: Sequence[str] | None = None,
        vtk: bool | None = None,
    ) -> str:
        """What a run writes where the command line does not say otherwise.

        * ``step`` (number or formula, optional): histories at multiples of this time; at the steps [s]
        * ``histories`` (list of text, optional): what has columns in them, by names: nodes ("crank", "beam[4]", "beam.end", "plate[2,0]"), members with all their nodes, joints, springs, dampers, elements, states, functionals, and "energy"; everything
        * ``vtk`` (True or False, optional): meshes for ParaView; false
        """
    def optimization(
        self,
        *,
        minimize: str | None = None,
        maximize: str | None = None,
        sense: Literal['minimize', 'maximize'] | None = None,
        weights: Table | None = None,
        varying: Sequence[str] | None = None,
        scale: Scalar | None = None,
        screening: Scalar | None = None,
        constraint: Sequence[Table] | None = None,
        linear: Sequence[Table] | None = None,
    ) -> str:
        """What costate optimize does. The objective is minimize, maximize, or a sum with sense and weights.

        * ``minimize`` (text, optional): name of a functional, or of a mode, that is to become small
        * ``maximize`` (text, optional): name of one that is to become large
        * ``sense`` ("minimize" or "maximize", optional): of a sum; minimize
        * ``weights`` (table, optional): weights of functionals in a sum, by name
        * ``varying`` (list of text, optional): names of the design variables that may change, as they are listed; all
        * ``scale`` (number or formula, optional): size of the objective that is of the order of 1; its size at the start [unit]
        * ``screening`` (number or formula, optional): limits kept by more than this share need no gradient; every limit has one [-]
        * ``constraint`` (list of table constraint with functional, at_most, at_least, equal, scale, for, optional): limits of functionals and modes
        * ``linear`` (list of table linear with name, coefficients, at_most, at_least, equal, for, optional): limits of sums of design variables
        """
    def fit(
        self,
        *,
        varying: Sequence[str] | None = None,
        loss: Literal['linear', 'huber', 'soft_l1', 'cauchy'] | None = None,
        prior: Sequence[Table] | None = None,
    ) -> str:
        """How `costate fit` fits design variables within their bounds to what each `[[measurement]]` says.

        * ``varying`` (list of text, optional): names of the design variables that may change, as they are listed; all
        * ``loss`` ("linear" or "huber" or "soft_l1" or "cauchy", optional): what residuals cost, by their squares in units of deviations, as SciPy names and defines it: the last three keep outliers from pulling as far as their squares would; linear
        * ``prior`` (list of table prior with variable, mean, deviation, for, optional): what is known of design variables beside the measurements
        """

class _Section:
    """The section of beams and cables; axis 1 along the line, 2 and 3 across. For beams that taper its numbers may use `share`, the place along the length from 0 to 1: `width = "0.05 - 0.02 * share"`."""

    def rectangle(
        self,
        name: str,
        /,
        *,
        damping: Scalar | None = None,
        offset: Sequence[Scalar] | None = None,
        material: str,
        width: Scalar,
        height: Scalar,
    ) -> str:
        """Solid rectangle.
        The section of beams and cables; axis 1 along the line, 2 and 3 across. For beams that taper its numbers may use `share`, the place along the length from 0 to 1: `width = "0.05 - 0.02 * share"`.

        * ``damping`` (number or formula, optional): damping proportional to stiffness; none [s]
        * ``offset`` (list of 2 times number or formula, optional): of beams: the section moved away from the line along axes 2 and 3; not [m]
        * ``material`` (text): name of a material
        * ``width`` (number or formula): along axis 2 [m]
        * ``height`` (number or formula): along axis 3 [m]
        """
    def box(
        self,
        name: str,
        /,
        *,
        damping: Scalar | None = None,
        offset: Sequence[Scalar] | None = None,
        material: str,
        width: Scalar,
        height: Scalar,
        wall: Scalar,
    ) -> str:
        """Hollow rectangle.
        The section of beams and cables; axis 1 along the line, 2 and 3 across. For beams that taper its numbers may use `share`, the place along the length from 0 to 1: `width = "0.05 - 0.02 * share"`.

        * ``damping`` (number or formula, optional): damping proportional to stiffness; none [s]
        * ``offset`` (list of 2 times number or formula, optional): of beams: the section moved away from the line along axes 2 and 3; not [m]
        * ``material`` (text): name of a material
        * ``width`` (number or formula): outer size along axis 2 [m]
        * ``height`` (number or formula): outer size along axis 3 [m]
        * ``wall`` (number or formula): thickness of the wall [m]
        """
    def circle(
        self,
        name: str,
        /,
        *,
        damping: Scalar | None = None,
        offset: Sequence[Scalar] | None = None,
        material: str,
        diameter: Scalar,
    ) -> str:
        """Solid circle.
        The section of beams and cables; axis 1 along the line, 2 and 3 across. For beams that taper its numbers may use `share`, the place along the length from 0 to 1: `width = "0.05 - 0.02 * share"`.

        * ``damping`` (number or formula, optional): damping proportional to stiffness; none [s]
        * ``offset`` (list of 2 times number or formula, optional): of beams: the section moved away from the line along axes 2 and 3; not [m]
        * ``material`` (text): name of a material
        * ``diameter`` (number or formula): diameter [m]
        """
    def tube(
        self,
        name: str,
        /,
        *,
        damping: Scalar | None = None,
        offset: Sequence[Scalar] | None = None,
        material: str,
        diameter: Scalar,
        wall: Scalar,
    ) -> str:
        """Circular tube.
        The section of beams and cables; axis 1 along the line, 2 and 3 across. For beams that taper its numbers may use `share`, the place along the length from 0 to 1: `width = "0.05 - 0.02 * share"`.

        * ``damping`` (number or formula, optional): damping proportional to stiffness; none [s]
        * ``offset`` (list of 2 times number or formula, optional): of beams: the section moved away from the line along axes 2 and 3; not [m]
        * ``material`` (text): name of a material
        * ``diameter`` (number or formula): outer diameter [m]
        * ``wall`` (number or formula): thickness of the wall [m]
        """
    def beam(
        self,
        name: str,
        /,
        *,
        damping: Scalar | None = None,
        offset: Sequence[Scalar] | None = None,
        axial: Scalar | None = None,
        shear: Sequence[Scalar] | None = None,
        torsion: Scalar | None = None,
        bending: Sequence[Scalar] | None = None,
        mass: Scalar | None = None,
        inertia: Sequence[Scalar] | None = None,
        centre: Sequence[Scalar] | None = None,
        stiffness: Sequence[Scalar] | None = None,
    ) -> str:
        """By stiffness and inertia, for beams.
        The section of beams and cables; axis 1 along the line, 2 and 3 across. For beams that taper its numbers may use `share`, the place along the length from 0 to 1: `width = "0.05 - 0.02 * share"`.

        * ``damping`` (number or formula, optional): damping proportional to stiffness; none [s]
        * ``offset`` (list of 2 times number or formula, optional): of beams: the section moved away from the line along axes 2 and 3; not [m]
        * ``axial`` (number or formula, optional): EA; required unless `stiffness` is given, as the next three [N]
        * ``shear`` (list of 2 times number or formula, optional): GA along axes 2 and 3, shear factors included [N]
        * ``torsion`` (number or formula, optional): GJ [N m2]
        * ``bending`` (list of 2 times number or formula, optional): EI about axes 2 and 3 [N m2]
        * ``mass`` (number or formula, optional): mass for each length; 0 [kg/m]
        * ``inertia`` (list of 2 times number or formula, optional): second moments of mass about axes 2 and 3; 0 [kg m]
        * ``centre`` (list of 2 times number or formula, optional): mass centre along axes 2 and 3; on the line [m]
        * ``stiffness`` (list of 21 times number or formula, optional): upper triangle by rows of the symmetric stiffness against axial strain, shear 2 and 3, torsion, bending 2 and 3, instead of the numbers above; diagonal [N, N m, N m2]
        """
    def cable(
        self,
        name: str,
        /,
        *,
        damping: Scalar | None = None,
        offset: Sequence[Scalar] | None = None,
        axial: Scalar,
        bending: Scalar,
        mass: Scalar,
    ) -> str:
        """By stiffness and mass, for cables.
        The section of beams and cables; axis 1 along the line, 2 and 3 across. For beams that taper its numbers may use `share`, the place along the length from 0 to 1: `width = "0.05 - 0.02 * share"`.

        * ``damping`` (number or formula, optional): damping proportional to stiffness; none [s]
        * ``offset`` (list of 2 times number or formula, optional): of beams: the section moved away from the line along axes 2 and 3; not [m]
        * ``axial`` (number or formula): EA [N]
        * ``bending`` (number or formula): EI about every axis [N m2]
        * ``mass`` (number or formula): mass for each length [kg/m]
        """

class _Shell:
    """A shell of nine-node elements on a grid: nodes NAME[i, j] with i along the first direction from 0 to twice the elements, j along the second; edges NAME.first_start, NAME.first_end, NAME.second_start, NAME.second_end, and their nodes NAME.first_start[i]."""

    def plate(
        self,
        name: str,
        /,
        *,
        elements: Sequence[int | str],
        material: str | None = None,
        thickness: Scalar | Sequence[Scalar] | None = None,
        laminate: str | None = None,
        direction: Vector | None = None,
        damping: Scalar | None = None,
        clamped: Literal['first_start', 'first_end', 'second_start', 'second_end'] | Sequence[Literal['first_start', 'first_end', 'second_start', 'second_end']] | None = None,
        joined: str | Sequence[str] | None = None,
        held: Sequence[Table] | None = None,
        closed: bool | None = None,
        coincident: bool | None = None,
        corner: Vector | None = None,
        first: Vector,
        second: Vector,
    ) -> str:
        """Flat.
        A shell of nine-node elements on a grid: nodes NAME[i, j] with i along the first direction from 0 to twice the elements, j along the second; edges NAME.first_start, NAME.first_end, NAME.second_start, NAME.second_end, and their nodes NAME.first_start[i].

        * ``name`` (text): name, by which others refer to it
        * ``elements`` (list of 2 times whole number): elements along both directions
        * ``material`` (text, optional): name of a material; required unless `laminate` is given
        * ``thickness`` (number or formula, or list of number or formula, optional): thickness, or those of strips of equal width across the first direction, or a formula of the share of that direction, from 0 to 1, which is taken at the middle of each element; needed with material [m]
        * ``laminate`` (text, optional): name of a laminate
        * ``direction`` (vector, optional): of laminates: axis 1, projected on the surface; needed with laminate [-]
        * ``damping`` (number or formula, optional): damping proportional to stiffness; none [s]
        * ``clamped`` ("first_start" or "first_end" or "second_start" or "second_end", or list of "first_start" or "first_end" or "second_start" or "second_end", optional): edges that never move; none
        * ``joined`` (text, or list of text, optional): shells and walls whose nodes it takes over where its edges meet them, to a millionth of its diagonal: with each at least one; none
        * ``held`` (list of table held with place, node, for, optional): nodes of the grid that are there already; none
        * ``closed`` (True or False, optional): the first direction ends in the nodes where it starts; false
        * ``coincident`` (True or False, optional): nodes may stand at the same place, or on other faces, and are not joined: a slit; false
        * ``corner`` (vector, optional): a corner; the origin [m]
        * ``first`` (vector): edge along the first direction [m]
        * ``second`` (vector): edge along the second direction [m]
        """
    def cylinder(
        self,
        name: str,
        /,
        *,
        elements: Sequence[int | str],
        material: str | None = None,
        thickness: Scalar | Sequence[Scalar] | None = None,
        laminate: str | None = None,
        direction: Vector | None = None,
        damping: Scalar | None = None,
        clamped: Literal['first_start', 'first_end', 'second_start', 'second_end'] | Sequence[Literal['first_start', 'first_end', 'second_start', 'second_end']] | None = None,
        joined: str | Sequence[str] | None = None,
        held: Sequence[Table] | None = None,
        closed: bool | None = None,
        coincident: bool | None = None,
        from_: Vector,
        along: Vector,
        centre: Vector,
        axis: Vector,
        angle: Scalar,
    ) -> str:
        """Part of a circular cylinder.
        A shell of nine-node elements on a grid: nodes NAME[i, j] with i along the first direction from 0 to twice the elements, j along the second; edges NAME.first_start, NAME.first_end, NAME.second_start, NAME.second_end, and their nodes NAME.first_start[i].

        * ``name`` (text): name, by which others refer to it
        * ``elements`` (list of 2 times whole number): elements along both directions
        * ``material`` (text, optional): name of a material; required unless `laminate` is given
        * ``thickness`` (number or formula, or list of number or formula, optional): thickness, or those of strips of equal width across the first direction, or a formula of the share of that direction, from 0 to 1, which is taken at the middle of each element; needed with material [m]
        * ``laminate`` (text, optional): name of a laminate
        * ``direction`` (vector, optional): of laminates: axis 1, projected on the surface; needed with laminate [-]
        * ``damping`` (number or formula, optional): damping proportional to stiffness; none [s]
        * ``clamped`` ("first_start" or "first_end" or "second_start" or "second_end", or list of "first_start" or "first_end" or "second_start" or "second_end", optional): edges that never move; none
        * ``joined`` (text, or list of text, optional): shells and walls whose nodes it takes over where its edges meet them, to a millionth of its diagonal: with each at least one; none
        * ``held`` (list of table held with place, node, for, optional): nodes of the grid that are there already; none
        * ``closed`` (True or False, optional): the first direction ends in the nodes where it starts; false
        * ``coincident`` (True or False, optional): nodes may stand at the same place, or on other faces, and are not joined: a slit; false
        * ``from_`` (vector): where the edge line starts [m]
        * ``along`` (vector): the edge line, which is the second direction [m]
        * ``centre`` (vector): a point of the axis [m]
        * ``axis`` (vector): unit vector of the axis [-]
        * ``angle`` (number or formula): turn of the edge line about the axis, which is the first direction [rad]
        """
    def sphere_patch(
        self,
        name: str,
        /,
        *,
        elements: Sequence[int | str],
        material: str | None = None,
        thickness: Scalar | Sequence[Scalar] | None = None,
        laminate: str | None = None,
        direction: Vector | None = None,
        damping: Scalar | None = None,
        clamped: Literal['first_start', 'first_end', 'second_start', 'second_end'] | Sequence[Literal['first_start', 'first_end', 'second_start', 'second_end']] | None = None,
        joined: str | Sequence[str] | None = None,
        held: Sequence[Table] | None = None,
        closed: bool | None = None,
        coincident: bool | None = None,
        centre: Vector,
        radius: Scalar,
        longitude: Sequence[Scalar],
        latitude: Sequence[Scalar],
    ) -> str:
        """Patch of a sphere between longitudes and latitudes about z.
        A shell of nine-node elements on a grid: nodes NAME[i, j] with i along the first direction from 0 to twice the elements, j along the second; edges NAME.first_start, NAME.first_end, NAME.second_start, NAME.second_end, and their nodes NAME.first_start[i].

        * ``name`` (text): name, by which others refer to it
        * ``elements`` (list of 2 times whole number): elements along both directions
        * ``material`` (text, optional): name of a material; required unless `laminate` is given
        * ``thickness`` (number or formula, or list of number or formula, optional): thickness, or those of strips of equal width across the first direction, or a formula of the share of that direction, from 0 to 1, which is taken at the middle of each element; needed with material [m]
        * ``laminate`` (text, optional): name of a laminate
        * ``direction`` (vector, optional): of laminates: axis 1, projected on the surface; needed with laminate [-]
        * ``damping`` (number or formula, optional): damping proportional to stiffness; none [s]
        * ``clamped`` ("first_start" or "first_end" or "second_start" or "second_end", or list of "first_start" or "first_end" or "second_start" or "second_end", optional): edges that never move; none
        * ``joined`` (text, or list of text, optional): shells and walls whose nodes it takes over where its edges meet them, to a millionth of its diagonal: with each at least one; none
        * ``held`` (list of table held with place, node, for, optional): nodes of the grid that are there already; none
        * ``closed`` (True or False, optional): the first direction ends in the nodes where it starts; false
        * ``coincident`` (True or False, optional): nodes may stand at the same place, or on other faces, and are not joined: a slit; false
        * ``centre`` (vector): centre [m]
        * ``radius`` (number or formula): radius [m]
        * ``longitude`` (list of 2 times number or formula): from and to, the first direction [rad]
        * ``latitude`` (list of 2 times number or formula): from and to, the second direction [rad]
        """
    def sphere_face(
        self,
        name: str,
        /,
        *,
        elements: Sequence[int | str],
        material: str | None = None,
        thickness: Scalar | Sequence[Scalar] | None = None,
        laminate: str | None = None,
        direction: Vector | None = None,
        damping: Scalar | None = None,
        clamped: Literal['first_start', 'first_end', 'second_start', 'second_end'] | Sequence[Literal['first_start', 'first_end', 'second_start', 'second_end']] | None = None,
        joined: str | Sequence[str] | None = None,
        held: Sequence[Table] | None = None,
        closed: bool | None = None,
        coincident: bool | None = None,
        centre: Vector,
        radius: Scalar,
        first: Vector,
        second: Vector,
    ) -> str:
        """One of six parts of a sphere.
        A shell of nine-node elements on a grid: nodes NAME[i, j] with i along the first direction from 0 to twice the elements, j along the second; edges NAME.first_start, NAME.first_end, NAME.second_start, NAME.second_end, and their nodes NAME.first_start[i].

        * ``name`` (text): name, by which others refer to it
        * ``elements`` (list of 2 times whole number): elements along both directions
        * ``material`` (text, optional): name of a material; required unless `laminate` is given
        * ``thickness`` (number or formula, or list of number or formula, optional): thickness, or those of strips of equal width across the first direction, or a formula of the share of that direction, from 0 to 1, which is taken at the middle of each element; needed with material [m]
        * ``laminate`` (text, optional): name of a laminate
        * ``direction`` (vector, optional): of laminates: axis 1, projected on the surface; needed with laminate [-]
        * ``damping`` (number or formula, optional): damping proportional to stiffness; none [s]
        * ``clamped`` ("first_start" or "first_end" or "second_start" or "second_end", or list of "first_start" or "first_end" or "second_start" or "second_end", optional): edges that never move; none
        * ``joined`` (text, or list of text, optional): shells and walls whose nodes it takes over where its edges meet them, to a millionth of its diagonal: with each at least one; none
        * ``held`` (list of table held with place, node, for, optional): nodes of the grid that are there already; none
        * ``closed`` (True or False, optional): the first direction ends in the nodes where it starts; false
        * ``coincident`` (True or False, optional): nodes may stand at the same place, or on other faces, and are not joined: a slit; false
        * ``centre`` (vector): centre [m]
        * ``radius`` (number or formula): radius [m]
        * ``first`` (vector): unit vector along an edge of the face [-]
        * ``second`` (vector): unit vector along the other, at right angles [-]
        """

class _Mesh:
    """A shell on a mesh of quadrilaterals of four, eight and nine nodes and triangles of six. Node NAME[i] is the one with the number i of the file of Gmsh, or the i-th of the points from 0 on; NAME.SET are the nodes of a node set, which a physical curve or point is, or of a group of faces, NAME.SET[i] is one of them, counted from 0; NAME.GROUP are the elements of a group, which a physical surface is."""

    def gmsh(
        self,
        name: str,
        /,
        *,
        material: str | None = None,
        thickness: Scalar | None = None,
        laminate: str | None = None,
        direction: Vector | None = None,
        parts: Sequence[Table] | None = None,
        damping: Scalar | None = None,
        clamped: Sequence[str] | None = None,
        joined: str | Sequence[str] | None = None,
        nodes: Sequence[Table] | None = None,
        groups: Table | None = None,
        node_sets: Table | None = None,
        reverse: Sequence[str] | None = None,
        crease: Scalar | None = None,
        scale: Scalar | None = None,
        orientation: Table | None = None,
        position: Vector | None = None,
        coincident: bool | None = None,
        file: str,
    ) -> str:
        """From a file of Gmsh, version 2 or 4, text or binary; triangles of three nodes are raised to six.
        A shell on a mesh of quadrilaterals of four, eight and nine nodes and triangles of six. Node NAME[i] is the one with the number i of the file of Gmsh, or the i-th of the points from 0 on; NAME.SET are the nodes of a node set, which a physical curve or point is, or of a group of faces, NAME.SET[i] is one of them, counted from 0; NAME.GROUP are the elements of a group, which a physical surface is.

        * ``name`` (text): name, by which others refer to it
        * ``material`` (text, optional): name of a material; required unless `laminate` or `parts` are given
        * ``thickness`` (number or formula, optional): thickness of faces that have no part; may use design variables of faces and nodes; needed with material but with parts [m]
        * ``laminate`` (text, optional): name of a laminate
        * ``direction`` (vector, optional): of laminates: axis 1, projected on the surface; needed with laminate [-]
        * ``parts`` (list of table parts with of, material, thickness, laminate, direction, for, optional): sections of groups of faces; all faces have one
        * ``damping`` (number or formula, optional): damping proportional to stiffness; none [s]
        * ``clamped`` (list of text, optional): node sets, or groups of faces, whose nodes never move; none
        * ``joined`` (text, or list of text, optional): shells, meshes and walls whose nodes it takes over where its outer edges meet them, to a millionth of its diagonal: with each at least one; none
        * ``nodes`` (list of table nodes with at, node, for, optional): nodes that are there already; none
        * ``groups`` (table, optional): groups of faces by name, beside those of the file: numbers of the faces, or a condition such as "norm([x, y, 0]) > 0.5 and z < 1" that holds at the mean of their corners, in coordinates before scale; none
        * ``node_sets`` (table, optional): node sets by name, beside those of the file: numbers of the nodes, or a condition such as "abs(x) < 1e-6", in coordinates before scale; none
        * ``reverse`` (list of text, optional): groups of faces that are turned round, so that their normals point to the other side, with what hangs together with them; none
        * ``crease`` (number or formula, optional): faces at a larger angle meet in an edge, which keeps its angle; 45 deg [rad]
        * ``scale`` (number or formula, optional): by which the points are multiplied, such as 0.001 for a mesh in millimetres; 1 [-]
        * ``orientation`` (table orientation of type angle, x_axis, euler_parameters, optional): turn of the points about the origin, after scale; none
        * ``position`` (vector, optional): by which the points are moved, after orientation; 0 [m]
        * ``coincident`` (True or False, optional): nodes may stand at the same place, or on other faces, and are not joined: a slit; false
        * ``file`` (text): path of the file, from the folder of this file on
        """
    def faces(
        self,
        name: str,
        /,
        *,
        material: str | None = None,
        thickness: Scalar | None = None,
        laminate: str | None = None,
        direction: Vector | None = None,
        parts: Sequence[Table] | None = None,
        damping: Scalar | None = None,
        clamped: Sequence[str] | None = None,
        joined: str | Sequence[str] | None = None,
        nodes: Sequence[Table] | None = None,
        groups: Table | None = None,
        node_sets: Table | None = None,
        reverse: Sequence[str] | None = None,
        crease: Scalar | None = None,
        scale: Scalar | None = None,
        orientation: Table | None = None,
        position: Vector | None = None,
        coincident: bool | None = None,
        points: Sequence[Vector],
        faces: Sequence[Sequence[int]],
    ) -> str:
        """From points and faces here.
        A shell on a mesh of quadrilaterals of four, eight and nine nodes and triangles of six. Node NAME[i] is the one with the number i of the file of Gmsh, or the i-th of the points from 0 on; NAME.SET are the nodes of a node set, which a physical curve or point is, or of a group of faces, NAME.SET[i] is one of them, counted from 0; NAME.GROUP are the elements of a group, which a physical surface is.

        * ``name`` (text): name, by which others refer to it
        * ``material`` (text, optional): name of a material; required unless `laminate` or `parts` are given
        * ``thickness`` (number or formula, optional): thickness of faces that have no part; may use design variables of faces and nodes; needed with material but with parts [m]
        * ``laminate`` (text, optional): name of a laminate
        * ``direction`` (vector, optional): of laminates: axis 1, projected on the surface; needed with laminate [-]
        * ``parts`` (list of table parts with of, material, thickness, laminate, direction, for, optional): sections of groups of faces; all faces have one
        * ``damping`` (number or formula, optional): damping proportional to stiffness; none [s]
        * ``clamped`` (list of text, optional): node sets, or groups of faces, whose nodes never move; none
        * ``joined`` (text, or list of text, optional): shells, meshes and walls whose nodes it takes over where its outer edges meet them, to a millionth of its diagonal: with each at least one; none
        * ``nodes`` (list of table nodes with at, node, for, optional): nodes that are there already; none
        * ``groups`` (table, optional): groups of faces by name, beside those of the file: numbers of the faces, or a condition such as "norm([x, y, 0]) > 0.5 and z < 1" that holds at the mean of their corners, in coordinates before scale; none
        * ``node_sets`` (table, optional): node sets by name, beside those of the file: numbers of the nodes, or a condition such as "abs(x) < 1e-6", in coordinates before scale; none
        * ``reverse`` (list of text, optional): groups of faces that are turned round, so that their normals point to the other side, with what hangs together with them; none
        * ``crease`` (number or formula, optional): faces at a larger angle meet in an edge, which keeps its angle; 45 deg [rad]
        * ``scale`` (number or formula, optional): by which the points are multiplied, such as 0.001 for a mesh in millimetres; 1 [-]
        * ``orientation`` (table orientation of type angle, x_axis, euler_parameters, optional): turn of the points about the origin, after scale; none
        * ``position`` (vector, optional): by which the points are moved, after orientation; 0 [m]
        * ``coincident`` (True or False, optional): nodes may stand at the same place, or on other faces, and are not joined: a slit; false
        * ``points`` (list of vector): points, counted from 0 on [m]
        * ``faces`` (list of list of whole number): points of each face: corners counterclockwise as seen from where the normal points to, then the middles of the edges from the first corner on, then the middle
        """

class _ThinWalls:
    """A member of thin walls of shells along a line; nodes of its ends are NAME.start, NAME.end, and NAME.start[i] one of them."""

    def box_tube(
        self,
        name: str,
        /,
        *,
        start: Vector | None = None,
        along: Vector,
        first_axis: Vector,
        twist: Scalar | None = None,
        elements: int | str,
        material: str,
        thickness: Scalar | Sequence[Scalar],
        width: Scalar,
        height: Scalar,
        across: Sequence[int | str],
    ) -> str:
        """Rectangular tube of four walls: lower, right, upper, left.
        A member of thin walls of shells along a line; nodes of its ends are NAME.start, NAME.end, and NAME.start[i] one of them.

        * ``name`` (text): name, by which others refer to it
        * ``start`` (vector, optional): where the origin of the profile starts; the origin [m]
        * ``along`` (vector): its line [m]
        * ``first_axis`` (vector): axis 1 of the profile, at right angles to the line [-]
        * ``twist`` (number or formula, optional): turn of the profile about the line from start to end; 0 [rad]
        * ``elements`` (whole number): elements along the line
        * ``material`` (text): name of a material
        * ``thickness`` (number or formula, or list of number or formula): thickness, or that of each wall [m]
        * ``width`` (number or formula): of the middle lines along axis 1 [m]
        * ``height`` (number or formula): of the middle lines along axis 2 [m]
        * ``across`` (list of 2 times whole number): elements across lower and upper, and right and left walls
        """
    def i_section(
        self,
        name: str,
        /,
        *,
        start: Vector | None = None,
        along: Vector,
        first_axis: Vector,
        twist: Scalar | None = None,
        elements: int | str,
        material: str,
        thickness: Scalar | Sequence[Scalar],
        width: Scalar,
        height: Scalar,
        across: Sequence[int | str],
    ) -> str:
        """Two flanges and a web: both halves of the lower flange, of the upper one, web.
        A member of thin walls of shells along a line; nodes of its ends are NAME.start, NAME.end, and NAME.start[i] one of them.

        * ``name`` (text): name, by which others refer to it
        * ``start`` (vector, optional): where the origin of the profile starts; the origin [m]
        * ``along`` (vector): its line [m]
        * ``first_axis`` (vector): axis 1 of the profile, at right angles to the line [-]
        * ``twist`` (number or formula, optional): turn of the profile about the line from start to end; 0 [rad]
        * ``elements`` (whole number): elements along the line
        * ``material`` (text): name of a material
        * ``thickness`` (number or formula, or list of number or formula): thickness, or that of each wall [m]
        * ``width`` (number or formula): of the flanges along axis 1 [m]
        * ``height`` (number or formula): of the web along axis 2 [m]
        * ``across`` (list of 2 times whole number): elements across half a flange, and the web
        """
    def profile(
        self,
        name: str,
        /,
        *,
        start: Vector | None = None,
        along: Vector,
        first_axis: Vector,
        twist: Scalar | None = None,
        elements: int | str,
        material: str,
        thickness: Scalar | Sequence[Scalar],
        corners: Sequence[Sequence[Scalar]],
        walls: Sequence[Table],
    ) -> str:
        """Walls between corners.
        A member of thin walls of shells along a line; nodes of its ends are NAME.start, NAME.end, and NAME.start[i] one of them.

        * ``name`` (text): name, by which others refer to it
        * ``start`` (vector, optional): where the origin of the profile starts; the origin [m]
        * ``along`` (vector): its line [m]
        * ``first_axis`` (vector): axis 1 of the profile, at right angles to the line [-]
        * ``twist`` (number or formula, optional): turn of the profile about the line from start to end; 0 [rad]
        * ``elements`` (whole number): elements along the line
        * ``material`` (text): name of a material
        * ``thickness`` (number or formula, or list of number or formula): thickness, or that of each wall [m]
        * ``corners`` (list of list of 2 times number or formula): places along axes 1 and 2 [m]
        * ``walls`` (list of table walls with between, elements, for): walls between corners
        """

class _State:
    """States z of first order, z' = f(z, nodes, t), as of a controller, an actuator, the slip of a tyre, inflow. Formulas know nodes as those of an [[element]] do; where a state is a node c of others, their formulas know c.NAME of its values and of its outputs."""

    def formula(
        self,
        name: str,
        /,
        *,
        nodes: Table | None = None,
        define: Table | None = None,
        table: Table | None = None,
        breakpoints: Sequence[Scalar] | None = None,
        initial: Table,
        rate: Table,
        output: Table | None = None,
    ) -> str:
        """By its rates, whose formulas know its own values by their names.
        States z of first order, z' = f(z, nodes, t), as of a controller, an actuator, the slip of a tyre, inflow. Formulas know nodes as those of an [[element]] do; where a state is a node c of others, their formulas know c.NAME of its values and of its outputs.

        * ``name`` (text): name, by which others refer to it
        * ``nodes`` (table, optional): nodes, or points of them, by the names that the formulas give them; none
        * ``define`` (table, optional): names for formulas that the other formulas here use, later ones those before them; none
        * ``table`` (table, optional): tables that the formulas here call by their names, as those of [table]; none
        * ``breakpoints`` (list of number or formula, optional): from the times when jumps and bends of formulas of t were not found from these: not needed, any [s]
        * ``initial`` (table): values at the start by their names [-]
        * ``rate`` (table): rates of all of them by the same names [1/s]
        * ``output`` (table, optional): numbers or vectors that others know beside the values, by their names; none [-]
        """
    def lag(
        self,
        name: str,
        /,
        *,
        nodes: Table | None = None,
        define: Table | None = None,
        table: Table | None = None,
        breakpoints: Sequence[Scalar] | None = None,
        input: Scalar,
        time_constant: Scalar,
        gain: Scalar | None = None,
        initial: Scalar | None = None,
    ) -> str:
        """A lag of first order, as of an actuator or a sensor: T z' = k u - z; others know z as NAME.value, z' as NAME.rate.
        States z of first order, z' = f(z, nodes, t), as of a controller, an actuator, the slip of a tyre, inflow. Formulas know nodes as those of an [[element]] do; where a state is a node c of others, their formulas know c.NAME of its values and of its outputs.

        * ``name`` (text): name, by which others refer to it
        * ``nodes`` (table, optional): nodes, or points of them, by the names that the formulas give them; none
        * ``define`` (table, optional): names for formulas that the other formulas here use, later ones those before them; none
        * ``table`` (table, optional): tables that the formulas here call by their names, as those of [table]; none
        * ``breakpoints`` (list of number or formula, optional): from the times when jumps and bends of formulas of t were not found from these: not needed, any [s]
        * ``input`` (number or formula): u [-]
        * ``time_constant`` (number or formula): T [s]
        * ``gain`` (number or formula, optional): k; 1 [-]
        * ``initial`` (number or formula, optional): z at the start; 0 [-]
        """
    def pid(
        self,
        name: str,
        /,
        *,
        nodes: Table | None = None,
        define: Table | None = None,
        table: Table | None = None,
        breakpoints: Sequence[Scalar] | None = None,
        measured: Scalar,
        set_point: Scalar,
        proportional: Scalar | None = None,
        integral: Scalar | None = None,
        derivative: Scalar | None = None,
        filter_time: Scalar | None = None,
        error_rate: Scalar | None = None,
        initial: Scalar | None = None,
        initial_error: Scalar | None = None,
        least: Scalar | None = None,
        most: Scalar | None = None,
        tracking_time: Scalar | None = None,
    ) -> str:
        """A PID controller of the error e = set_point - measured: u = kp e + I + kd d, I' = ki e, where d is e', filtered (d = (e - z) / T, z' = d) or as it is given; others know u as NAME.output, e as NAME.error, I as NAME.integral_term. With limits u is held within them, and I' = ki e + (u - kp e - I - kd d) / tracking_time (no windup).
        States z of first order, z' = f(z, nodes, t), as of a controller, an actuator, the slip of a tyre, inflow. Formulas know nodes as those of an [[element]] do; where a state is a node c of others, their formulas know c.NAME of its values and of its outputs.

        * ``name`` (text): name, by which others refer to it
        * ``nodes`` (table, optional): nodes, or points of them, by the names that the formulas give them; none
        * ``define`` (table, optional): names for formulas that the other formulas here use, later ones those before them; none
        * ``table`` (table, optional): tables that the formulas here call by their names, as those of [table]; none
        * ``breakpoints`` (list of number or formula, optional): from the times when jumps and bends of formulas of t were not found from these: not needed, any [s]
        * ``measured`` (number or formula): what is controlled [-]
        * ``set_point`` (number or formula): what it should be [-]
        * ``proportional`` (number or formula, optional): kp; 0 [-]
        * ``integral`` (number or formula, optional): ki; 0 [1/s]
        * ``derivative`` (number or formula, optional): kd, with filter_time or error_rate; 0 [s]
        * ``filter_time`` (number or formula, optional): T of the filter of the derivative [s]
        * ``error_rate`` (number or formula, optional): e' where the mechanism knows it, as of rates of joints; filtered [1/s]
        * ``initial`` (number or formula, optional): I at the start; 0 [-]
        * ``initial_error`` (number or formula, optional): z at the start, e for a start without a kick; 0 [-]
        * ``least`` (number or formula, optional): lower limit of u; none [-]
        * ``most`` (number or formula, optional): upper limit of u; none [-]
        * ``tracking_time`` (number or formula, optional): time in which I follows u at a limit; needed with one [s]
        """

class _Joint:
    """What holds nodes together. Geometry is given in the world at the start."""

    def spherical(
        self,
        name: str,
        /,
        *,
        stiffness: str | Sequence[Scalar] | None = None,
        damping: str | Sequence[Scalar] | None = None,
        present: bool | None = None,
        strength: Scalar | None = None,
        between: Sequence[str],
        point: Vector | None = None,
    ) -> str:
        """A common point.
        What holds nodes together. Geometry is given in the world at the start.

        * ``name`` (text): name, by which others refer to it
        * ``stiffness`` (text, or list of number or formula, optional): of each of its equations, but where it rolls: the joint is soft, a spring and damper for each in its place; rigid [N/m, N m/rad]
        * ``damping`` (text, or list of number or formula, optional): of a soft joint, of each of its equations; 0 [N s/m, N m s/rad]
        * ``present`` (True or False, optional): whether it is there at the start: an event may lock it later; true
        * ``strength`` (number or formula, optional): size of its force, or of its moment where it has no forces, beyond which it opens for good; none [N, N m]
        * ``between`` (list of 2 times text): both nodes, a and b
        * ``point`` (vector, optional): place in the world at the start; that of b [m]
        """
    def revolute(
        self,
        name: str,
        /,
        *,
        stiffness: str | Sequence[Scalar] | None = None,
        damping: str | Sequence[Scalar] | None = None,
        present: bool | None = None,
        strength: Scalar | None = None,
        between: Sequence[str],
        point: Vector | None = None,
        axis: Vector,
    ) -> str:
        """A common point and axis.
        What holds nodes together. Geometry is given in the world at the start.

        * ``name`` (text): name, by which others refer to it
        * ``stiffness`` (text, or list of number or formula, optional): of each of its equations, but where it rolls: the joint is soft, a spring and damper for each in its place; rigid [N/m, N m/rad]
        * ``damping`` (text, or list of number or formula, optional): of a soft joint, of each of its equations; 0 [N s/m, N m s/rad]
        * ``present`` (True or False, optional): whether it is there at the start: an event may lock it later; true
        * ``strength`` (number or formula, optional): size of its force, or of its moment where it has no forces, beyond which it opens for good; none [N, N m]
        * ``between`` (list of 2 times text): both nodes, a and b
        * ``point`` (vector, optional): place in the world at the start; that of b [m]
        * ``axis`` (vector): axis in the world at the start, of any length [-]
        """
    def fixed(
        self,
        name: str,
        /,
        *,
        stiffness: str | Sequence[Scalar] | None = None,
        damping: str | Sequence[Scalar] | None = None,
        present: bool | None = None,
        strength: Scalar | None = None,
        between: Sequence[str],
        point: Vector | None = None,
    ) -> str:
        """Two bodies welded together.
        What holds nodes together. Geometry is given in the world at the start.

        * ``name`` (text): name, by which others refer to it
        * ``stiffness`` (text, or list of number or formula, optional): of each of its equations, but where it rolls: the joint is soft, a spring and damper for each in its place; rigid [N/m, N m/rad]
        * ``damping`` (text, or list of number or formula, optional): of a soft joint, of each of its equations; 0 [N s/m, N m s/rad]
        * ``present`` (True or False, optional): whether it is there at the start: an event may lock it later; true
        * ``strength`` (number or formula, optional): size of its force, or of its moment where it has no forces, beyond which it opens for good; none [N, N m]
        * ``between`` (list of 2 times text): both nodes, a and b
        * ``point`` (vector, optional): place in the world at the start; that of b [m]
        """
    def rigid_link(
        self,
        name: str,
        /,
        *,
        stiffness: str | Sequence[Scalar] | None = None,
        damping: str | Sequence[Scalar] | None = None,
        present: bool | None = None,
        strength: Scalar | None = None,
        between: Sequence[str],
    ) -> str:
        """B carried along by a as it stands.
        What holds nodes together. Geometry is given in the world at the start.

        * ``name`` (text): name, by which others refer to it
        * ``stiffness`` (text, or list of number or formula, optional): of each of its equations, but where it rolls: the joint is soft, a spring and damper for each in its place; rigid [N/m, N m/rad]
        * ``damping`` (text, or list of number or formula, optional): of a soft joint, of each of its equations; 0 [N s/m, N m s/rad]
        * ``present`` (True or False, optional): whether it is there at the start: an event may lock it later; true
        * ``strength`` (number or formula, optional): size of its force, or of its moment where it has no forces, beyond which it opens for good; none [N, N m]
        * ``between`` (list of 2 times text): both nodes, a and b
        """
    def distance(
        self,
        name: str,
        /,
        *,
        stiffness: str | Sequence[Scalar] | None = None,
        damping: str | Sequence[Scalar] | None = None,
        present: bool | None = None,
        strength: Scalar | None = None,
        between: Sequence[str],
        points: Sequence[Vector] | None = None,
    ) -> str:
        """A massless link between points.
        What holds nodes together. Geometry is given in the world at the start.

        * ``name`` (text): name, by which others refer to it
        * ``stiffness`` (text, or list of number or formula, optional): of each of its equations, but where it rolls: the joint is soft, a spring and damper for each in its place; rigid [N/m, N m/rad]
        * ``damping`` (text, or list of number or formula, optional): of a soft joint, of each of its equations; 0 [N s/m, N m s/rad]
        * ``present`` (True or False, optional): whether it is there at the start: an event may lock it later; true
        * ``strength`` (number or formula, optional): size of its force, or of its moment where it has no forces, beyond which it opens for good; none [N, N m]
        * ``between`` (list of 2 times text): both nodes, a and b
        * ``points`` (list of vector, optional): where it takes hold of a and b; both nodes [m]
        """
    def prismatic(
        self,
        name: str,
        /,
        *,
        stiffness: str | Sequence[Scalar] | None = None,
        damping: str | Sequence[Scalar] | None = None,
        present: bool | None = None,
        strength: Scalar | None = None,
        between: Sequence[str],
        point: Vector | None = None,
        axis: Vector,
    ) -> str:
        """B slides along an axis without turning.
        What holds nodes together. Geometry is given in the world at the start.

        * ``name`` (text): name, by which others refer to it
        * ``stiffness`` (text, or list of number or formula, optional): of each of its equations, but where it rolls: the joint is soft, a spring and damper for each in its place; rigid [N/m, N m/rad]
        * ``damping`` (text, or list of number or formula, optional): of a soft joint, of each of its equations; 0 [N s/m, N m s/rad]
        * ``present`` (True or False, optional): whether it is there at the start: an event may lock it later; true
        * ``strength`` (number or formula, optional): size of its force, or of its moment where it has no forces, beyond which it opens for good; none [N, N m]
        * ``between`` (list of 2 times text): both nodes, a and b
        * ``point`` (vector, optional): place in the world at the start; that of b [m]
        * ``axis`` (vector): axis in the world at the start, of any length [-]
        """
    def cylindrical(
        self,
        name: str,
        /,
        *,
        stiffness: str | Sequence[Scalar] | None = None,
        damping: str | Sequence[Scalar] | None = None,
        present: bool | None = None,
        strength: Scalar | None = None,
        between: Sequence[str],
        point: Vector | None = None,
        axis: Vector,
    ) -> str:
        """B slides along and turns about an axis.
        What holds nodes together. Geometry is given in the world at the start.

        * ``name`` (text): name, by which others refer to it
        * ``stiffness`` (text, or list of number or formula, optional): of each of its equations, but where it rolls: the joint is soft, a spring and damper for each in its place; rigid [N/m, N m/rad]
        * ``damping`` (text, or list of number or formula, optional): of a soft joint, of each of its equations; 0 [N s/m, N m s/rad]
        * ``present`` (True or False, optional): whether it is there at the start: an event may lock it later; true
        * ``strength`` (number or formula, optional): size of its force, or of its moment where it has no forces, beyond which it opens for good; none [N, N m]
        * ``between`` (list of 2 times text): both nodes, a and b
        * ``point`` (vector, optional): place in the world at the start; that of b [m]
        * ``axis`` (vector): axis in the world at the start, of any length [-]
        """
    def planar(
        self,
        name: str,
        /,
        *,
        stiffness: str | Sequence[Scalar] | None = None,
        damping: str | Sequence[Scalar] | None = None,
        present: bool | None = None,
        strength: Scalar | None = None,
        between: Sequence[str],
        point: Vector | None = None,
        normal: Vector,
    ) -> str:
        """B slides on a plane and turns about its normal.
        What holds nodes together. Geometry is given in the world at the start.

        * ``name`` (text): name, by which others refer to it
        * ``stiffness`` (text, or list of number or formula, optional): of each of its equations, but where it rolls: the joint is soft, a spring and damper for each in its place; rigid [N/m, N m/rad]
        * ``damping`` (text, or list of number or formula, optional): of a soft joint, of each of its equations; 0 [N s/m, N m s/rad]
        * ``present`` (True or False, optional): whether it is there at the start: an event may lock it later; true
        * ``strength`` (number or formula, optional): size of its force, or of its moment where it has no forces, beyond which it opens for good; none [N, N m]
        * ``between`` (list of 2 times text): both nodes, a and b
        * ``point`` (vector, optional): place in the world at the start; that of b [m]
        * ``normal`` (vector): normal in the world at the start, of any length [-]
        """
    def universal(
        self,
        name: str,
        /,
        *,
        stiffness: str | Sequence[Scalar] | None = None,
        damping: str | Sequence[Scalar] | None = None,
        present: bool | None = None,
        strength: Scalar | None = None,
        between: Sequence[str],
        point: Vector | None = None,
        pin_a: Vector,
        pin_b: Vector,
    ) -> str:
        """A cross with one pin in a and one in b.
        What holds nodes together. Geometry is given in the world at the start.

        * ``name`` (text): name, by which others refer to it
        * ``stiffness`` (text, or list of number or formula, optional): of each of its equations, but where it rolls: the joint is soft, a spring and damper for each in its place; rigid [N/m, N m/rad]
        * ``damping`` (text, or list of number or formula, optional): of a soft joint, of each of its equations; 0 [N s/m, N m s/rad]
        * ``present`` (True or False, optional): whether it is there at the start: an event may lock it later; true
        * ``strength`` (number or formula, optional): size of its force, or of its moment where it has no forces, beyond which it opens for good; none [N, N m]
        * ``between`` (list of 2 times text): both nodes, a and b
        * ``point`` (vector, optional): place in the world at the start; that of b [m]
        * ``pin_a`` (vector): pin in a, at right angles to the other [-]
        * ``pin_b`` (vector): pin in b [-]
        """
    def helical(
        self,
        name: str,
        /,
        *,
        stiffness: str | Sequence[Scalar] | None = None,
        damping: str | Sequence[Scalar] | None = None,
        present: bool | None = None,
        strength: Scalar | None = None,
        between: Sequence[str],
        point: Vector | None = None,
        axis: Vector,
        pitch: Scalar,
    ) -> str:
        """A screw.
        What holds nodes together. Geometry is given in the world at the start.

        * ``name`` (text): name, by which others refer to it
        * ``stiffness`` (text, or list of number or formula, optional): of each of its equations, but where it rolls: the joint is soft, a spring and damper for each in its place; rigid [N/m, N m/rad]
        * ``damping`` (text, or list of number or formula, optional): of a soft joint, of each of its equations; 0 [N s/m, N m s/rad]
        * ``present`` (True or False, optional): whether it is there at the start: an event may lock it later; true
        * ``strength`` (number or formula, optional): size of its force, or of its moment where it has no forces, beyond which it opens for good; none [N, N m]
        * ``between`` (list of 2 times text): both nodes, a and b
        * ``point`` (vector, optional): place in the world at the start; that of b [m]
        * ``axis`` (vector): axis in the world at the start, of any length [-]
        * ``pitch`` (number or formula): advance with each turn; negative for a left-handed thread [m]
        """
    def point_on_line(
        self,
        name: str,
        /,
        *,
        stiffness: str | Sequence[Scalar] | None = None,
        damping: str | Sequence[Scalar] | None = None,
        present: bool | None = None,
        strength: Scalar | None = None,
        between: Sequence[str],
        point: Vector | None = None,
        axis: Vector,
    ) -> str:
        """A point of b on a line of a.
        What holds nodes together. Geometry is given in the world at the start.

        * ``name`` (text): name, by which others refer to it
        * ``stiffness`` (text, or list of number or formula, optional): of each of its equations, but where it rolls: the joint is soft, a spring and damper for each in its place; rigid [N/m, N m/rad]
        * ``damping`` (text, or list of number or formula, optional): of a soft joint, of each of its equations; 0 [N s/m, N m s/rad]
        * ``present`` (True or False, optional): whether it is there at the start: an event may lock it later; true
        * ``strength`` (number or formula, optional): size of its force, or of its moment where it has no forces, beyond which it opens for good; none [N, N m]
        * ``between`` (list of 2 times text): both nodes, a and b
        * ``point`` (vector, optional): place in the world at the start; that of b [m]
        * ``axis`` (vector): axis in the world at the start, of any length [-]
        """
    def point_in_plane(
        self,
        name: str,
        /,
        *,
        stiffness: str | Sequence[Scalar] | None = None,
        damping: str | Sequence[Scalar] | None = None,
        present: bool | None = None,
        strength: Scalar | None = None,
        between: Sequence[str],
        point: Vector | None = None,
        normal: Vector,
    ) -> str:
        """A point of b in a plane of a.
        What holds nodes together. Geometry is given in the world at the start.

        * ``name`` (text): name, by which others refer to it
        * ``stiffness`` (text, or list of number or formula, optional): of each of its equations, but where it rolls: the joint is soft, a spring and damper for each in its place; rigid [N/m, N m/rad]
        * ``damping`` (text, or list of number or formula, optional): of a soft joint, of each of its equations; 0 [N s/m, N m s/rad]
        * ``present`` (True or False, optional): whether it is there at the start: an event may lock it later; true
        * ``strength`` (number or formula, optional): size of its force, or of its moment where it has no forces, beyond which it opens for good; none [N, N m]
        * ``between`` (list of 2 times text): both nodes, a and b
        * ``point`` (vector, optional): place in the world at the start; that of b [m]
        * ``normal`` (vector): normal in the world at the start, of any length [-]
        """
    def gear(
        self,
        name: str,
        /,
        *,
        stiffness: str | Sequence[Scalar] | None = None,
        damping: str | Sequence[Scalar] | None = None,
        present: bool | None = None,
        strength: Scalar | None = None,
        between: Sequence[str],
        radii: Sequence[Scalar],
    ) -> str:
        """Gears on two joint angles.
        What holds nodes together. Geometry is given in the world at the start.

        * ``name`` (text): name, by which others refer to it
        * ``stiffness`` (text, or list of number or formula, optional): of each of its equations, but where it rolls: the joint is soft, a spring and damper for each in its place; rigid [N/m, N m/rad]
        * ``damping`` (text, or list of number or formula, optional): of a soft joint, of each of its equations; 0 [N s/m, N m s/rad]
        * ``present`` (True or False, optional): whether it is there at the start: an event may lock it later; true
        * ``strength`` (number or formula, optional): size of its force, or of its moment where it has no forces, beyond which it opens for good; none [N, N m]
        * ``between`` (list of 2 times text): both nodes, a and b
        * ``radii`` (list of 2 times number or formula): pitch radii; of one sign for external gears [m]
        """
    def rack_and_pinion(
        self,
        name: str,
        /,
        *,
        stiffness: str | Sequence[Scalar] | None = None,
        damping: str | Sequence[Scalar] | None = None,
        present: bool | None = None,
        strength: Scalar | None = None,
        between: Sequence[str],
        centre: Vector,
        contact: Vector,
        axis: Vector,
    ) -> str:
        """A rack on a pinion.
        What holds nodes together. Geometry is given in the world at the start.

        * ``name`` (text): name, by which others refer to it
        * ``stiffness`` (text, or list of number or formula, optional): of each of its equations, but where it rolls: the joint is soft, a spring and damper for each in its place; rigid [N/m, N m/rad]
        * ``damping`` (text, or list of number or formula, optional): of a soft joint, of each of its equations; 0 [N s/m, N m s/rad]
        * ``present`` (True or False, optional): whether it is there at the start: an event may lock it later; true
        * ``strength`` (number or formula, optional): size of its force, or of its moment where it has no forces, beyond which it opens for good; none [N, N m]
        * ``between`` (list of 3 times text): carrier, pinion, rack
        * ``centre`` (vector): a point of the pinion's axis [m]
        * ``contact`` (vector): where the pitch circle touches the rack [m]
        * ``axis`` (vector): axis in the world at the start, of any length [-]
        """
    def cable_weld(
        self,
        name: str,
        /,
        *,
        stiffness: str | Sequence[Scalar] | None = None,
        damping: str | Sequence[Scalar] | None = None,
        present: bool | None = None,
        strength: Scalar | None = None,
        between: Sequence[str],
        holds: Literal['direction', 'vector'] | None = None,
    ) -> str:
        """B, a cable's node, welded to body a.
        What holds nodes together. Geometry is given in the world at the start.

        * ``name`` (text): name, by which others refer to it
        * ``stiffness`` (text, or list of number or formula, optional): of each of its equations, but where it rolls: the joint is soft, a spring and damper for each in its place; rigid [N/m, N m/rad]
        * ``damping`` (text, or list of number or formula, optional): of a soft joint, of each of its equations; 0 [N s/m, N m s/rad]
        * ``present`` (True or False, optional): whether it is there at the start: an event may lock it later; true
        * ``strength`` (number or formula, optional): size of its force, or of its moment where it has no forces, beyond which it opens for good; none [N, N m]
        * ``between`` (list of 2 times text): both nodes, a and b
        * ``holds`` ("direction" or "vector", optional): the direction of its slope, or its stretch, too; direction
        """
    def cable_hinge(
        self,
        name: str,
        /,
        *,
        stiffness: str | Sequence[Scalar] | None = None,
        damping: str | Sequence[Scalar] | None = None,
        present: bool | None = None,
        strength: Scalar | None = None,
        between: Sequence[str],
        axis: Vector,
    ) -> str:
        """B, a cable's node, on a hinge of body a.
        What holds nodes together. Geometry is given in the world at the start.

        * ``name`` (text): name, by which others refer to it
        * ``stiffness`` (text, or list of number or formula, optional): of each of its equations, but where it rolls: the joint is soft, a spring and damper for each in its place; rigid [N/m, N m/rad]
        * ``damping`` (text, or list of number or formula, optional): of a soft joint, of each of its equations; 0 [N s/m, N m s/rad]
        * ``present`` (True or False, optional): whether it is there at the start: an event may lock it later; true
        * ``strength`` (number or formula, optional): size of its force, or of its moment where it has no forces, beyond which it opens for good; none [N, N m]
        * ``between`` (list of 2 times text): both nodes, a and b
        * ``axis`` (vector): axis in the world at the start, of any length [-]
        """
    def cable_corner(
        self,
        name: str,
        /,
        *,
        stiffness: str | Sequence[Scalar] | None = None,
        damping: str | Sequence[Scalar] | None = None,
        present: bool | None = None,
        strength: Scalar | None = None,
        between: Sequence[str],
    ) -> str:
        """Nodes of two cables welded to each other.
        What holds nodes together. Geometry is given in the world at the start.

        * ``name`` (text): name, by which others refer to it
        * ``stiffness`` (text, or list of number or formula, optional): of each of its equations, but where it rolls: the joint is soft, a spring and damper for each in its place; rigid [N/m, N m/rad]
        * ``damping`` (text, or list of number or formula, optional): of a soft joint, of each of its equations; 0 [N s/m, N m s/rad]
        * ``present`` (True or False, optional): whether it is there at the start: an event may lock it later; true
        * ``strength`` (number or formula, optional): size of its force, or of its moment where it has no forces, beyond which it opens for good; none [N, N m]
        * ``between`` (list of 2 times text): both nodes, a and b
        """
    def formula(
        self,
        name: str,
        /,
        *,
        stiffness: str | Sequence[Scalar] | None = None,
        damping: str | Sequence[Scalar] | None = None,
        present: bool | None = None,
        strength: Scalar | None = None,
        nodes: Table,
        define: Table | None = None,
        table: Table | None = None,
        equations: Sequence[Scalar],
        breakpoints: Sequence[Scalar] | None = None,
    ) -> str:
        """Formulas of the places of its nodes, and of the time, that are zero.
        What holds nodes together. Geometry is given in the world at the start.

        * ``name`` (text): name, by which others refer to it
        * ``stiffness`` (text, or list of number or formula, optional): of each of its equations, but where it rolls: the joint is soft, a spring and damper for each in its place; rigid [N/m, N m/rad]
        * ``damping`` (text, or list of number or formula, optional): of a soft joint, of each of its equations; 0 [N s/m, N m s/rad]
        * ``present`` (True or False, optional): whether it is there at the start: an event may lock it later; true
        * ``strength`` (number or formula, optional): size of its force, or of its moment where it has no forces, beyond which it opens for good; none [N, N m]
        * ``nodes`` (table): nodes, or points of them, by the names that the formulas give them
        * ``define`` (table, optional): names for formulas that the other formulas here use, later ones those before them; none
        * ``table`` (table, optional): tables that the formulas here call by their names, as those of [table]; none
        * ``equations`` (list of number or formula): what is zero, as in ["norm(b.position - a.position) - 0.5"] [m, rad]
        * ``breakpoints`` (list of number or formula, optional): from the times when jumps and bends of formulas of t were not found from these: not needed, any [s]
        """
    def rolling_sphere(
        self,
        name: str,
        /,
        *,
        stiffness: str | Sequence[Scalar] | None = None,
        damping: str | Sequence[Scalar] | None = None,
        present: bool | None = None,
        strength: Scalar | None = None,
        between: Sequence[str],
        centre: Vector | None = None,
        normal: Vector,
        radius: Scalar,
    ) -> str:
        """B, a sphere, rolls on a plane of a.
        What holds nodes together. Geometry is given in the world at the start.

        * ``name`` (text): name, by which others refer to it
        * ``stiffness`` (text, or list of number or formula, optional): of each of its equations, but where it rolls: the joint is soft, a spring and damper for each in its place; rigid [N/m, N m/rad]
        * ``damping`` (text, or list of number or formula, optional): of a soft joint, of each of its equations; 0 [N s/m, N m s/rad]
        * ``present`` (True or False, optional): whether it is there at the start: an event may lock it later; true
        * ``strength`` (number or formula, optional): size of its force, or of its moment where it has no forces, beyond which it opens for good; none [N, N m]
        * ``between`` (list of 2 times text): both nodes, a and b
        * ``centre`` (vector, optional): centre of the sphere; the place of b [m]
        * ``normal`` (vector): normal in the world at the start, of any length [-]
        * ``radius`` (number or formula): radius [m]
        """
    def rolling_disc(
        self,
        name: str,
        /,
        *,
        stiffness: str | Sequence[Scalar] | None = None,
        damping: str | Sequence[Scalar] | None = None,
        present: bool | None = None,
        strength: Scalar | None = None,
        between: Sequence[str],
        centre: Vector | None = None,
        axis: Vector,
        point: Vector | None = None,
        normal: Vector,
        radius: Scalar,
    ) -> str:
        """B, a thin disc, rolls on a plane of a.
        What holds nodes together. Geometry is given in the world at the start.

        * ``name`` (text): name, by which others refer to it
        * ``stiffness`` (text, or list of number or formula, optional): of each of its equations, but where it rolls: the joint is soft, a spring and damper for each in its place; rigid [N/m, N m/rad]
        * ``damping`` (text, or list of number or formula, optional): of a soft joint, of each of its equations; 0 [N s/m, N m s/rad]
        * ``present`` (True or False, optional): whether it is there at the start: an event may lock it later; true
        * ``strength`` (number or formula, optional): size of its force, or of its moment where it has no forces, beyond which it opens for good; none [N, N m]
        * ``between`` (list of 2 times text): both nodes, a and b
        * ``centre`` (vector, optional): centre of the disc; the place of b [m]
        * ``axis`` (vector): axis in the world at the start, of any length [-]
        * ``point`` (vector, optional): point of the plane; the place of a [m]
        * ``normal`` (vector): normal in the world at the start, of any length [-]
        * ``radius`` (number or formula): radius [m]
        """

class _Driver:
    """A prescribed motion."""

    def rotation(
        self,
        name: str,
        /,
        *,
        between: Sequence[str],
        axis: Vector,
        angle: float | str | Table,
    ) -> str:
        """The angle of b against a about an axis, zero as they stand.
        A prescribed motion.

        * ``name`` (text): name, by which others refer to it
        * ``between`` (list of 2 times text): both nodes, a and b
        * ``axis`` (vector): axis in the world at the start, of any length [-]
        * ``angle`` (number, or text, or table a function of time of type constant, constant_rate, sine, smooth_ramp, step, lines, table, formula): angle over time [rad]
        """
    def translation(
        self,
        name: str,
        /,
        *,
        between: Sequence[str],
        axis: Vector,
        origin: Vector | None = None,
        point: Vector | None = None,
        displacement: float | str | Table,
    ) -> str:
        """A point of b along an axis of a.
        A prescribed motion.

        * ``name`` (text): name, by which others refer to it
        * ``between`` (list of 2 times text): both nodes, a and b
        * ``axis`` (vector): axis in the world at the start, of any length [-]
        * ``origin`` (vector, optional): where the displacement is zero; the place of a [m]
        * ``point`` (vector, optional): place in the world at the start; that of b [m]
        * ``displacement`` (number, or text, or table a function of time of type constant, constant_rate, sine, smooth_ramp, step, lines, table, formula): displacement over time [m]
        """

class _Spring:
    """A spring."""

    def line(
        self,
        name: str,
        /,
        *,
        between: Sequence[str],
        points: Sequence[Vector] | None = None,
        stiffness: Scalar,
        rest_length: Scalar | None = None,
    ) -> str:
        """Along the line between two points.
        A spring.

        * ``name`` (text): name, by which others refer to it
        * ``between`` (list of 2 times text): both nodes, a and b
        * ``points`` (list of vector, optional): where it takes hold of a and b; both nodes [m]
        * ``stiffness`` (number or formula): stiffness [N/m]
        * ``rest_length`` (number or formula, optional): length without force; the length at the start [m]
        """
    def torsion(
        self,
        name: str,
        /,
        *,
        between: Sequence[str],
        axis: Vector,
        stiffness: Scalar,
        damping: Scalar | None = None,
        rest_angle: Scalar | None = None,
    ) -> str:
        """About an axis, with a damper.
        A spring.

        * ``name`` (text): name, by which others refer to it
        * ``between`` (list of 2 times text): both nodes, a and b
        * ``axis`` (vector): axis in the world at the start, of any length [-]
        * ``stiffness`` (number or formula): stiffness [N m/rad]
        * ``damping`` (number or formula, optional): damping; 0 [N m s/rad]
        * ``rest_angle`` (number or formula, optional): angle without moment, zero as they stand; 0 [rad]
        """
    def slide(
        self,
        name: str,
        /,
        *,
        between: Sequence[str],
        origin: Vector | None = None,
        point: Vector | None = None,
        axis: Vector,
        stiffness: Scalar,
        damping: Scalar | None = None,
        rest_displacement: Scalar | None = None,
    ) -> str:
        """Along an axis of a, with a damper.
        A spring.

        * ``name`` (text): name, by which others refer to it
        * ``between`` (list of 2 times text): both nodes, a and b
        * ``origin`` (vector, optional): where the displacement is zero; the place of a [m]
        * ``point`` (vector, optional): place in the world at the start; that of b [m]
        * ``axis`` (vector): axis in the world at the start, of any length [-]
        * ``stiffness`` (number or formula): stiffness [N/m]
        * ``damping`` (number or formula, optional): damping; 0 [N s/m]
        * ``rest_displacement`` (number or formula, optional): displacement without force; 0 [m]
        """
    def angle(
        self,
        name: str,
        /,
        *,
        on: str,
        index: int | str | None = None,
        stiffness: Scalar,
        damping: Scalar | None = None,
        rest_angle: Scalar | None = None,
    ) -> str:
        """On a joint angle, with a damper.
        A spring.

        * ``name`` (text): name, by which others refer to it
        * ``on`` (text): joint angle
        * ``index`` (whole number, optional): which coordinate of the node, from 0; 0
        * ``stiffness`` (number or formula): stiffness [N m/rad]
        * ``damping`` (number or formula, optional): damping; 0 [N m s/rad]
        * ``rest_angle`` (number or formula, optional): angle without moment; 0 [rad]
        """
    def bushing(
        self,
        name: str,
        /,
        *,
        between: Sequence[str],
        point: Vector | None = None,
        orientation: Table | None = None,
        stiffness: Sequence[Scalar],
        damping: Sequence[Scalar] | None = None,
    ) -> str:
        """Along and about three axes, with dampers; at rest as the bodies stand.
        A spring.

        * ``name`` (text): name, by which others refer to it
        * ``between`` (list of 2 times text): both nodes, a and b
        * ``point`` (vector, optional): place in the world at the start; that of b [m]
        * ``orientation`` (table orientation of type angle, x_axis, euler_parameters, optional): its axes; those of the world
        * ``stiffness`` (list of 6 times number or formula): along and about x, y, z [N/m, N m/rad]
        * ``damping`` (list of 6 times number or formula, optional): along and about x, y, z; 0 [N s/m, N m s/rad]
        """
    def line_law(
        self,
        name: str,
        /,
        *,
        between: Sequence[str],
        points: Sequence[Vector] | None = None,
        rest_length: Scalar | None = None,
        force: float | str | Table | None = None,
        energy: float | str | Table | None = None,
    ) -> str:
        """Between two points, by a law of one's own; s is how much longer the line is than at rest.
        A spring.

        * ``name`` (text): name, by which others refer to it
        * ``between`` (list of 2 times text): both nodes, a and b
        * ``points`` (list of vector, optional): where it takes hold of a and b; both nodes [m]
        * ``rest_length`` (number or formula, optional): length at which s is 0; that at the start [m]
        * ``force`` (number, or text, or table a table of s of type lines, table, optional): force that pulls s back: a formula of s, its rate v and the time t, or a table of s [N]
        * ``energy`` (number, or text, or table a table of s of type lines, table, optional): energy U that is stored: a formula of s, or a table; its slope acts like force [J]
        """
    def torsion_law(
        self,
        name: str,
        /,
        *,
        between: Sequence[str],
        axis: Vector,
        moment: float | str | Table | None = None,
        energy: float | str | Table | None = None,
    ) -> str:
        """About an axis, by a law of one's own; s is the angle, zero as they stand, within half a turn.
        A spring.

        * ``name`` (text): name, by which others refer to it
        * ``between`` (list of 2 times text): both nodes, a and b
        * ``axis`` (vector): axis in the world at the start, of any length [-]
        * ``moment`` (number, or text, or table a table of s of type lines, table, optional): moment that turns s back: a formula of s, its rate v and the time t, or a table of s [N m]
        * ``energy`` (number, or text, or table a table of s of type lines, table, optional): energy U that is stored: a formula of s, or a table; its slope acts like force [J]
        """
    def slide_law(
        self,
        name: str,
        /,
        *,
        between: Sequence[str],
        origin: Vector | None = None,
        point: Vector | None = None,
        axis: Vector,
        force: float | str | Table | None = None,
        energy: float | str | Table | None = None,
    ) -> str:
        """Along an axis of a, by a law of one's own; s is the displacement of b from the origin.
        A spring.

        * ``name`` (text): name, by which others refer to it
        * ``between`` (list of 2 times text): both nodes, a and b
        * ``origin`` (vector, optional): where s is 0; the place of a [m]
        * ``point`` (vector, optional): place in the world at the start; that of b [m]
        * ``axis`` (vector): axis in the world at the start, of any length [-]
        * ``force`` (number, or text, or table a table of s of type lines, table, optional): force that pulls s back: a formula of s, its rate v and the time t, or a table of s [N]
        * ``energy`` (number, or text, or table a table of s of type lines, table, optional): energy U that is stored: a formula of s, or a table; its slope acts like force [J]
        """
    def angle_law(
        self,
        name: str,
        /,
        *,
        on: str,
        index: int | str | None = None,
        moment: float | str | Table | None = None,
        energy: float | str | Table | None = None,
    ) -> str:
        """On a joint angle over any number of turns, by a law of one's own; s is the angle.
        A spring.

        * ``name`` (text): name, by which others refer to it
        * ``on`` (text): node
        * ``index`` (whole number, optional): which coordinate of the node, from 0; 0
        * ``moment`` (number, or text, or table a table of s of type lines, table, optional): moment that turns s back: a formula of s, its rate v and the time t, or a table of s [N m]
        * ``energy`` (number, or text, or table a table of s of type lines, table, optional): energy U that is stored: a formula of s, or a table; its slope acts like force [J]
        """

class _Damper:
    """A damper."""

    def line(
        self,
        name: str,
        /,
        *,
        between: Sequence[str],
        points: Sequence[Vector] | None = None,
        damping: Scalar,
    ) -> str:
        """On the rate of the distance of two points.
        A damper.

        * ``name`` (text): name, by which others refer to it
        * ``between`` (list of 2 times text): both nodes, a and b
        * ``points`` (list of vector, optional): where it takes hold of a and b; both nodes [m]
        * ``damping`` (number or formula): damping [N s/m]
        """
    def vector(
        self,
        name: str,
        /,
        *,
        between: Sequence[str],
        points: Sequence[Vector] | None = None,
        damping: Scalar,
    ) -> str:
        """On the whole relative velocity of two points.
        A damper.

        * ``name`` (text): name, by which others refer to it
        * ``between`` (list of 2 times text): both nodes, a and b
        * ``points`` (list of vector, optional): where it takes hold of a and b; both nodes [m]
        * ``damping`` (number or formula): damping [N s/m]
        """

class _Shape:
    """What of a node touches others: a contact is between two of them."""

    def point(
        self,
        name: str,
        /,
        *,
        on: str,
        centre: Vector | None = None,
    ) -> str:
        """A point.
        What of a node touches others: a contact is between two of them.

        * ``name`` (text): name, by which others refer to it
        * ``on`` (text): node, or ground
        * ``centre`` (vector, optional): its centre in the world at the start; the place of the node [m]
        """
    def sphere(
        self,
        name: str,
        /,
        *,
        on: str,
        centre: Vector | None = None,
        radius: Scalar,
    ) -> str:
        """A sphere.
        What of a node touches others: a contact is between two of them.

        * ``name`` (text): name, by which others refer to it
        * ``on`` (text): node, or ground
        * ``centre`` (vector, optional): its centre in the world at the start; the place of the node [m]
        * ``radius`` (number or formula): radius [m]
        """
    def capsule(
        self,
        name: str,
        /,
        *,
        on: str,
        from_: Vector,
        to: Vector,
        radius: Scalar,
    ) -> str:
        """A cylinder with a half sphere at each end: a contact with a plane is one of each of these.
        What of a node touches others: a contact is between two of them.

        * ``name`` (text): name, by which others refer to it
        * ``on`` (text): node, or ground
        * ``from_`` (vector): middle of its first end in the world at the start [m]
        * ``to`` (vector): that of its second one [m]
        * ``radius`` (number or formula): radius [m]
        """
    def cylinder(
        self,
        name: str,
        /,
        *,
        on: str,
        from_: Vector,
        to: Vector,
        radius: Scalar,
    ) -> str:
        """A cylinder with flat ends: a contact with a plane is one of each of its rims, and has no derivatives where it stands on an end.
        What of a node touches others: a contact is between two of them.

        * ``name`` (text): name, by which others refer to it
        * ``on`` (text): node, or ground
        * ``from_`` (vector): middle of its first end in the world at the start [m]
        * ``to`` (vector): that of its second one [m]
        * ``radius`` (number or formula): radius [m]
        """
    def box(
        self,
        name: str,
        /,
        *,
        on: str,
        centre: Vector | None = None,
        size: Vector,
        axis: Vector | None = None,
        second_axis: Vector | None = None,
    ) -> str:
        """A box: a contact with a plane is one of each of its 8 corners.
        What of a node touches others: a contact is between two of them.

        * ``name`` (text): name, by which others refer to it
        * ``on`` (text): node, or ground
        * ``centre`` (vector, optional): its centre in the world at the start; the place of the node [m]
        * ``size`` (vector): lengths of its edges along axis, second_axis, and at right angles to both [m]
        * ``axis`` (vector, optional): direction of its first edges in the world at the start; x [-]
        * ``second_axis`` (vector, optional): that of its second ones, at right angles to the first; y [-]
        """
    def plane(
        self,
        name: str,
        /,
        *,
        on: str,
        point: Vector | None = None,
        normal: Vector,
    ) -> str:
        """A plane, with all that is behind it.
        What of a node touches others: a contact is between two of them.

        * ``name`` (text): name, by which others refer to it
        * ``on`` (text): node, or ground
        * ``point`` (vector, optional): point of it in the world at the start; the place of the node [m]
        * ``normal`` (vector): direction away from it, in the world at the start [-]
        """

class _Functional:
    """A number that a run gives, with its gradient."""

    def position(
        self,
        name: str,
        /,
        *,
        over: Literal['initial', 'terminal', 'integral'] | Table,
        on: str,
        point: Vector | None = None,
        direction: Vector,
    ) -> str:
        """Coordinate of a point along a direction [m].
        A number that a run gives, with its gradient.

        * ``name`` (text): name, by which others refer to it
        * ``over`` ("initial" or "terminal" or "integral", or table an aggregate with aggregate, sharpness, size, times, normalized, continuous): value at the start, at the end, integral, or an aggregate
        * ``on`` (text): node
        * ``point`` (vector, optional): point of the node, in the world at the start; the node's place [m]
        * ``direction`` (vector): direction in the world [-]
        """
    def velocity(
        self,
        name: str,
        /,
        *,
        over: Literal['initial', 'terminal', 'integral'] | Table,
        on: str,
        point: Vector | None = None,
        direction: Vector,
    ) -> str:
        """Velocity of a point along a direction [m/s].
        A number that a run gives, with its gradient.

        * ``name`` (text): name, by which others refer to it
        * ``over`` ("initial" or "terminal" or "integral", or table an aggregate with aggregate, sharpness, size, times, normalized, continuous): value at the start, at the end, integral, or an aggregate
        * ``on`` (text): node
        * ``point`` (vector, optional): point of the node, in the world at the start; the node's place [m]
        * ``direction`` (vector): direction in the world [-]
        """
    def acceleration(
        self,
        name: str,
        /,
        *,
        over: Literal['initial', 'terminal', 'integral'] | Table,
        on: str,
        point: Vector | None = None,
        direction: Vector,
        gravity: Vector | None = None,
    ) -> str:
        """Acceleration of a point along a direction that turns with its body, less gravity, as a sensor shows it [m/s2].
        A number that a run gives, with its gradient.

        * ``name`` (text): name, by which others refer to it
        * ``over`` ("initial" or "terminal" or "integral", or table an aggregate with aggregate, sharpness, size, times, normalized, continuous): value at the start, at the end, integral, or an aggregate
        * ``on`` (text): node
        * ``point`` (vector, optional): point of the node, in the world at the start; the node's place [m]
        * ``direction`` (vector): direction in the world [-]
        * ``gravity`` (vector, optional): gravity, which a sensor at rest shows upwards; none [m/s2]
        """
    def target(
        self,
        name: str,
        /,
        *,
        over: Literal['initial', 'terminal', 'integral'] | Table,
        on: str,
        point: Vector | None = None,
        target: Vector | None = None,
    ) -> str:
        """Squared distance of a point from a target in the world [m2].
        A number that a run gives, with its gradient.

        * ``name`` (text): name, by which others refer to it
        * ``over`` ("initial" or "terminal" or "integral", or table an aggregate with aggregate, sharpness, size, times, normalized, continuous): value at the start, at the end, integral, or an aggregate
        * ``on`` (text): node
        * ``point`` (vector, optional): point of the node, in the world at the start; the node's place [m]
        * ``target`` (vector, optional): target; where the point starts [m]
        """
    def distance(
        self,
        name: str,
        /,
        *,
        over: Literal['initial', 'terminal', 'integral'] | Table,
        between: Sequence[str],
        points: Sequence[Vector] | None = None,
    ) -> str:
        """Distance of two points [m].
        A number that a run gives, with its gradient.

        * ``name`` (text): name, by which others refer to it
        * ``over`` ("initial" or "terminal" or "integral", or table an aggregate with aggregate, sharpness, size, times, normalized, continuous): value at the start, at the end, integral, or an aggregate
        * ``between`` (list of 2 times text): both nodes, a and b
        * ``points`` (list of vector, optional): where it takes hold of a and b; both nodes [m]
        """
    def coordinate(
        self,
        name: str,
        /,
        *,
        over: Literal['initial', 'terminal', 'integral'] | Table,
        on: str,
        index: int | str | None = None,
    ) -> str:
        """One coordinate of a node, such as a joint angle.
        A number that a run gives, with its gradient.

        * ``name`` (text): name, by which others refer to it
        * ``over`` ("initial" or "terminal" or "integral", or table an aggregate with aggregate, sharpness, size, times, normalized, continuous): value at the start, at the end, integral, or an aggregate
        * ``on`` (text): node
        * ``index`` (whole number, optional): which coordinate of the node, from 0; 0
        """
    def joint_angle(
        self,
        name: str,
        /,
        *,
        over: Literal['initial', 'terminal', 'integral'] | Table,
        between: Sequence[str],
        axis: Vector,
    ) -> str:
        """Angle of b against a about an axis, in (-pi, pi] [rad].
        A number that a run gives, with its gradient.

        * ``name`` (text): name, by which others refer to it
        * ``over`` ("initial" or "terminal" or "integral", or table an aggregate with aggregate, sharpness, size, times, normalized, continuous): value at the start, at the end, integral, or an aggregate
        * ``between`` (list of 2 times text): both nodes, a and b
        * ``axis`` (vector): axis in the world at the start, of any length [-]
        """
    def joint_rate(
        self,
        name: str,
        /,
        *,
        over: Literal['initial', 'terminal', 'integral'] | Table,
        between: Sequence[str],
        axis: Vector,
    ) -> str:
        """Angular velocity of b against a along an axis of a [rad/s].
        A number that a run gives, with its gradient.

        * ``name`` (text): name, by which others refer to it
        * ``over`` ("initial" or "terminal" or "integral", or table an aggregate with aggregate, sharpness, size, times, normalized, continuous): value at the start, at the end, integral, or an aggregate
        * ``between`` (list of 2 times text): both nodes, a and b
        * ``axis`` (vector): axis in the world at the start, of any length [-]
        """
    def joint_displacement(
        self,
        name: str,
        /,
        *,
        over: Literal['initial', 'terminal', 'integral'] | Table,
        between: Sequence[str],
        point: Vector | None = None,
        axis: Vector,
    ) -> str:
        """Displacement of a point of b along an axis of a since the start [m].
        A number that a run gives, with its gradient.

        * ``name`` (text): name, by which others refer to it
        * ``over`` ("initial" or "terminal" or "integral", or table an aggregate with aggregate, sharpness, size, times, normalized, continuous): value at the start, at the end, integral, or an aggregate
        * ``between`` (list of 2 times text): both nodes, a and b
        * ``point`` (vector, optional): place in the world at the start; that of b [m]
        * ``axis`` (vector): axis in the world at the start, of any length [-]
        """
    def joint_speed(
        self,
        name: str,
        /,
        *,
        over: Literal['initial', 'terminal', 'integral'] | Table,
        between: Sequence[str],
        point: Vector | None = None,
        axis: Vector,
    ) -> str:
        """Its rate [m/s].
        A number that a run gives, with its gradient.

        * ``name`` (text): name, by which others refer to it
        * ``over`` ("initial" or "terminal" or "integral", or table an aggregate with aggregate, sharpness, size, times, normalized, continuous): value at the start, at the end, integral, or an aggregate
        * ``between`` (list of 2 times text): both nodes, a and b
        * ``point`` (vector, optional): place in the world at the start; that of b [m]
        * ``axis`` (vector): axis in the world at the start, of any length [-]
        """
    def cable_deflection(
        self,
        name: str,
        /,
        *,
        over: Literal['initial', 'terminal', 'integral'] | Table,
        between: Sequence[str],
        normal: Vector,
    ) -> str:
        """Deflection of b, a cable's node, from the tangent at a [m].
        A number that a run gives, with its gradient.

        * ``name`` (text): name, by which others refer to it
        * ``over`` ("initial" or "terminal" or "integral", or table an aggregate with aggregate, sharpness, size, times, normalized, continuous): value at the start, at the end, integral, or an aggregate
        * ``between`` (list of 2 times text): both nodes, a and b
        * ``normal`` (vector): normal in the world at the start, of any length [-]
        """
    def formula(
        self,
        name: str,
        /,
        *,
        over: Literal['initial', 'terminal', 'integral'] | Table,
        nodes: Table,
        define: Table | None = None,
        table: Table | None = None,
        value: Scalar,
        unit: str | None = None,
    ) -> str:
        """A formula of its nodes and of the time.
        A number that a run gives, with its gradient.

        * ``name`` (text): name, by which others refer to it
        * ``over`` ("initial" or "terminal" or "integral", or table an aggregate with aggregate, sharpness, size, times, normalized, continuous): value at the start, at the end, integral, or an aggregate
        * ``nodes`` (table): nodes, or points of them, by the names that the formulas give them
        * ``define`` (table, optional): names for formulas that the other formulas here use, later ones those before them; none
        * ``table`` (table, optional): tables that the formulas here call by their names, as those of [table]; none
        * ``value`` (number or formula): the quantity, as in "dot(tip.velocity, [0, 0, 1])" [unit]
        * ``unit`` (text, optional): its unit, for tables and charts; -
        """
    def event_time(
        self,
        name: str,
        /,
        *,
        over: Literal['initial', 'terminal', 'integral'] | Table,
        event: str,
        which: Literal['stick', 'slip'] | None = None,
        number: int | str | None = None,
    ) -> str:
        """The time at which an event happens [s]; over = "terminal".
        A number that a run gives, with its gradient.

        * ``name`` (text): name, by which others refer to it
        * ``over`` ("initial" or "terminal" or "integral", or table an aggregate with aggregate, sharpness, size, times, normalized, continuous): value at the start, at the end, integral, or an aggregate
        * ``event`` (text): name of an event, of a stop, latch or contact that is hit, of a friction or clutch
        * ``which`` ("stick" or "slip", optional): where surfaces come to stick, or where they begin to slip; of a friction or clutch needed, of a contact where it is hit
        * ``number`` (whole number, optional): for which time it happens, counted from 1; 1
        """
    def impulse(
        self,
        name: str,
        /,
        *,
        over: Literal['initial', 'terminal', 'integral'] | Table,
        event: str,
    ) -> str:
        """The sum of the sizes of all impulses with which a stop or latch is hit [N s, N m s]; over = "terminal".
        A number that a run gives, with its gradient.

        * ``name`` (text): name, by which others refer to it
        * ``over`` ("initial" or "terminal" or "integral", or table an aggregate with aggregate, sharpness, size, times, normalized, continuous): value at the start, at the end, integral, or an aggregate
        * ``event`` (text): name of a stop, latch or contact
        """
    def reaction(
        self,
        name: str,
        /,
        *,
        over: Literal['initial', 'terminal', 'integral'] | Table,
        joint: str,
        weights: str | Sequence[Scalar],
    ) -> str:
        """Weighted sum of a joint's multipliers.
        A number that a run gives, with its gradient.

        * ``name`` (text): name, by which others refer to it
        * ``over`` ("initial" or "terminal" or "integral", or table an aggregate with aggregate, sharpness, size, times, normalized, continuous): value at the start, at the end, integral, or an aggregate
        * ``joint`` (text): name of a joint or driver
        * ``weights`` (text, or list of number or formula): a weight for each of its equations [-]
        """
    def reaction_norm(
        self,
        name: str,
        /,
        *,
        over: Literal['initial', 'terminal', 'integral'] | Table,
        joint: str,
    ) -> str:
        """Length of the forces among a joint's multipliers [N]; of its moments [N m] where it has no force.
        A number that a run gives, with its gradient.

        * ``name`` (text): name, by which others refer to it
        * ``over`` ("initial" or "terminal" or "integral", or table an aggregate with aggregate, sharpness, size, times, normalized, continuous): value at the start, at the end, integral, or an aggregate
        * ``joint`` (text): name of a joint or driver
        """
    def joint_load(
        self,
        name: str,
        /,
        *,
        over: Literal['initial', 'terminal', 'integral'] | Table,
        joint: str,
        on: str,
        point: Vector | None = None,
        frame: Literal['world', 'body'] | None = None,
        load: Literal['force', 'moment', 'force_norm', 'moment_norm'],
        direction: Vector | None = None,
    ) -> str:
        """Force or moment of a joint on one of its nodes [N, N m].
        A number that a run gives, with its gradient.

        * ``name`` (text): name, by which others refer to it
        * ``over`` ("initial" or "terminal" or "integral", or table an aggregate with aggregate, sharpness, size, times, normalized, continuous): value at the start, at the end, integral, or an aggregate
        * ``joint`` (text): name of a joint or driver
        * ``on`` (text): node
        * ``point`` (vector, optional): point of the node, in the world at the start; the node's place [m]
        * ``frame`` ("world" or "body", optional): direction fixed in the world, or turning with the node; world
        * ``load`` ("force" or "moment" or "force_norm" or "moment_norm"): which
        * ``direction`` (vector, optional): direction in the world at the start; needed but for norms [-]
        """
    def joint_power(
        self,
        name: str,
        /,
        *,
        over: Literal['initial', 'terminal', 'integral'] | Table,
        joint: str,
        on: str | None = None,
    ) -> str:
        """Power with which a joint or driver works on what it holds [W]: of a driver what it puts in; an integral is a work [J].
        A number that a run gives, with its gradient.

        * ``name`` (text): name, by which others refer to it
        * ``over`` ("initial" or "terminal" or "integral", or table an aggregate with aggregate, sharpness, size, times, normalized, continuous): value at the start, at the end, integral, or an aggregate
        * ``joint`` (text): name of a joint or driver
        * ``on`` (text, optional): one of its nodes, to which the joint hands on so much; all
        """
    def energy(
        self,
        name: str,
        /,
        *,
        over: Literal['initial', 'terminal', 'integral'] | Table,
    ) -> str:
        """Energy of all elements [J].
        A number that a run gives, with its gradient.

        * ``name`` (text): name, by which others refer to it
        * ``over`` ("initial" or "terminal" or "integral", or table an aggregate with aggregate, sharpness, size, times, normalized, continuous): value at the start, at the end, integral, or an aggregate
        """
    def power(
        self,
        name: str,
        /,
        *,
        over: Literal['initial', 'terminal', 'integral'] | Table,
        of: str | Sequence[str] | None = None,
    ) -> str:
        """Power of loads, dampers, actuators and losses, of all that is in no energy [W]; an integral is a work [J].
        A number that a run gives, with its gradient.

        * ``name`` (text): name, by which others refer to it
        * ``over`` ("initial" or "terminal" or "integral", or table an aggregate with aggregate, sharpness, size, times, normalized, continuous): value at the start, at the end, integral, or an aggregate
        * ``of`` (text, or list of text, optional): names of loads, springs, dampers, parts of one's own, members or groups; everything
        """
    def mass(
        self,
        name: str,
        /,
        *,
        over: Literal['initial', 'terminal', 'integral'] | Table,
        of: str | Sequence[str] | None = None,
    ) -> str:
        """Mass of some elements [kg].
        A number that a run gives, with its gradient.

        * ``name`` (text): name, by which others refer to it
        * ``over`` ("initial" or "terminal" or "integral", or table an aggregate with aggregate, sharpness, size, times, normalized, continuous): value at the start, at the end, integral, or an aggregate
        * ``of`` (text, or list of text, optional): names of beams, cables, shells, meshes, walls or groups, PLATE.GROUP of a mesh among them; everything
        """
    def strain_energy(
        self,
        name: str,
        /,
        *,
        over: Literal['initial', 'terminal', 'integral'] | Table,
        of: str | Sequence[str],
    ) -> str:
        """Energy stored in strains [J].
        A number that a run gives, with its gradient.

        * ``name`` (text): name, by which others refer to it
        * ``over`` ("initial" or "terminal" or "integral", or table an aggregate with aggregate, sharpness, size, times, normalized, continuous): value at the start, at the end, integral, or an aggregate
        * ``of`` (text, or list of text): names of beams, cables, shells, meshes, walls or groups, PLATE.GROUP of a mesh among them
        """
    def inertia_moment(
        self,
        name: str,
        /,
        *,
        over: Literal['initial', 'terminal', 'integral'] | Table,
        of: str | Sequence[str] | None = None,
        point: Vector | None = None,
        axis: Vector,
    ) -> str:
        """Moment of inertia about an axis [kg m2].
        A number that a run gives, with its gradient.

        * ``name`` (text): name, by which others refer to it
        * ``over`` ("initial" or "terminal" or "integral", or table an aggregate with aggregate, sharpness, size, times, normalized, continuous): value at the start, at the end, integral, or an aggregate
        * ``of`` (text, or list of text, optional): names of beams, cables, shells, meshes, walls or groups, PLATE.GROUP of a mesh among them; everything
        * ``point`` (vector, optional): point of the axis; the origin [m]
        * ``axis`` (vector): axis in the world at the start, of any length [-]
        """
    def von_mises(
        self,
        name: str,
        /,
        *,
        over: Literal['initial', 'terminal', 'integral'] | Table,
        of: str | Sequence[str],
        yield_stress: Scalar,
    ) -> str:
        """Von Mises stress by the yield stress [-]: on both surfaces of shells, on the outline of beams of a material and a shape, in the outer fibres of such cables.
        A number that a run gives, with its gradient.

        * ``name`` (text): name, by which others refer to it
        * ``over`` ("initial" or "terminal" or "integral", or table an aggregate with aggregate, sharpness, size, times, normalized, continuous): value at the start, at the end, integral, or an aggregate
        * ``of`` (text, or list of text): names of beams, cables, shells, meshes, walls or groups, PLATE.GROUP of a mesh among them
        * ``yield_stress`` (number or formula): yield stress [N/m2]
        """
    def tsai_wu(
        self,
        name: str,
        /,
        *,
        over: Literal['initial', 'terminal', 'integral'] | Table,
        of: str | Sequence[str],
        laminate: str,
    ) -> str:
        """Failure ratio of Tsai and Wu in laminates [-].
        A number that a run gives, with its gradient.

        * ``name`` (text): name, by which others refer to it
        * ``over`` ("initial" or "terminal" or "integral", or table an aggregate with aggregate, sharpness, size, times, normalized, continuous): value at the start, at the end, integral, or an aggregate
        * ``of`` (text, or list of text): names of beams, cables, shells, meshes, walls or groups, PLATE.GROUP of a mesh among them
        * ``laminate`` (text): name of the laminate, whose plies have strengths
        """
    def section_force(
        self,
        name: str,
        /,
        *,
        over: Literal['initial', 'terminal', 'integral'] | Table,
        beam: str,
        share: Scalar,
        component: Literal['axial', 'shear_2', 'shear_3', 'torsion', 'bending_2', 'bending_3'],
    ) -> str:
        """Force or moment in a section of a beam [N, N m].
        A number that a run gives, with its gradient.

        * ``name`` (text): name, by which others refer to it
        * ``over`` ("initial" or "terminal" or "integral", or table an aggregate with aggregate, sharpness, size, times, normalized, continuous): value at the start, at the end, integral, or an aggregate
        * ``beam`` (text): name of a beam
        * ``share`` (number or formula): place along its length, from 0 to 1 [-]
        * ``component`` ("axial" or "shear_2" or "shear_3" or "torsion" or "bending_2" or "bending_3"): axial, shear along axes 2 and 3, torsion, bending about axes 2 and 3
        """
    def section_forces(
        self,
        name: str,
        /,
        *,
        over: Literal['initial', 'terminal', 'integral'] | Table,
        of: str | Sequence[str],
        component: Literal['axial', 'shear_2', 'shear_3', 'torsion', 'bending_2', 'bending_3'],
    ) -> str:
        """Force or moment in all sections of beams [N, N m].
        A number that a run gives, with its gradient.

        * ``name`` (text): name, by which others refer to it
        * ``over`` ("initial" or "terminal" or "integral", or table an aggregate with aggregate, sharpness, size, times, normalized, continuous): value at the start, at the end, integral, or an aggregate
        * ``of`` (text, or list of text): names of beams, cables, shells, meshes, walls or groups, PLATE.GROUP of a mesh among them
        * ``component`` ("axial" or "shear_2" or "shear_3" or "torsion" or "bending_2" or "bending_3"): axial, shear along axes 2 and 3, torsion, bending about axes 2 and 3
        """
    def section_strain(
        self,
        name: str,
        /,
        *,
        over: Literal['initial', 'terminal', 'integral'] | Table,
        beam: str,
        share: Scalar,
        component: Literal['axial', 'shear_2', 'shear_3', 'torsion', 'bending_2', 'bending_3'],
    ) -> str:
        """Strain or curvature of a section of a beam [-, 1/m].
        A number that a run gives, with its gradient.

        * ``name`` (text): name, by which others refer to it
        * ``over`` ("initial" or "terminal" or "integral", or table an aggregate with aggregate, sharpness, size, times, normalized, continuous): value at the start, at the end, integral, or an aggregate
        * ``beam`` (text): name of a beam
        * ``share`` (number or formula): place along its length, from 0 to 1 [-]
        * ``component`` ("axial" or "shear_2" or "shear_3" or "torsion" or "bending_2" or "bending_3"): axial, shear along axes 2 and 3, torsion, bending about axes 2 and 3
        """
    def fibre_stress(
        self,
        name: str,
        /,
        *,
        over: Literal['initial', 'terminal', 'integral'] | Table,
        beam: str,
        share: Scalar,
        young: Scalar,
        fibre: Sequence[Scalar],
    ) -> str:
        """Axial stress of a fibre of a beam [N/m2].
        A number that a run gives, with its gradient.

        * ``name`` (text): name, by which others refer to it
        * ``over`` ("initial" or "terminal" or "integral", or table an aggregate with aggregate, sharpness, size, times, normalized, continuous): value at the start, at the end, integral, or an aggregate
        * ``beam`` (text): name of a beam
        * ``share`` (number or formula): place along its length, from 0 to 1 [-]
        * ``young`` (number or formula): Young's modulus [N/m2]
        * ``fibre`` (list of 2 times number or formula): place of the fibre along axes 2 and 3 [m]
        """
    def cable_strain(
        self,
        name: str,
        /,
        *,
        over: Literal['initial', 'terminal', 'integral'] | Table,
        cable: str,
        share: Scalar,
    ) -> str:
        """Axial strain of a cable [-].
        A number that a run gives, with its gradient.

        * ``name`` (text): name, by which others refer to it
        * ``over`` ("initial" or "terminal" or "integral", or table an aggregate with aggregate, sharpness, size, times, normalized, continuous): value at the start, at the end, integral, or an aggregate
        * ``cable`` (text): name of a cable
        * ``share`` (number or formula): place along its length, from 0 to 1 [-]
        """
    def cable_curvature(
        self,
        name: str,
        /,
        *,
        over: Literal['initial', 'terminal', 'integral'] | Table,
        cable: str,
        share: Scalar,
    ) -> str:
        """Curvature of a cable [1/m].
        A number that a run gives, with its gradient.

        * ``name`` (text): name, by which others refer to it
        * ``over`` ("initial" or "terminal" or "integral", or table an aggregate with aggregate, sharpness, size, times, normalized, continuous): value at the start, at the end, integral, or an aggregate
        * ``cable`` (text): name of a cable
        * ``share`` (number or formula): place along its length, from 0 to 1 [-]
        """
    def cable_stress(
        self,
        name: str,
        /,
        *,
        over: Literal['initial', 'terminal', 'integral'] | Table,
        cable: str,
        share: Scalar,
        young: Scalar,
        distance: Scalar | None = None,
    ) -> str:
        """Axial stress of a fibre of a cable [N/m2].
        A number that a run gives, with its gradient.

        * ``name`` (text): name, by which others refer to it
        * ``over`` ("initial" or "terminal" or "integral", or table an aggregate with aggregate, sharpness, size, times, normalized, continuous): value at the start, at the end, integral, or an aggregate
        * ``cable`` (text): name of a cable
        * ``share`` (number or formula): place along its length, from 0 to 1 [-]
        * ``young`` (number or formula): Young's modulus [N/m2]
        * ``distance`` (number or formula, optional): of the fibre from the axis; 0 [m]
        """
    def largest_cable_stress(
        self,
        name: str,
        /,
        *,
        over: Literal['initial', 'terminal', 'integral'] | Table,
        cable: str,
        young: Scalar,
        distance: Scalar,
    ) -> str:
        """Smooth maximum over time and length of the axial stress of a cable [N/m2]; over is an aggregate smooth_maximum of the run.
        A number that a run gives, with its gradient.

        * ``name`` (text): name, by which others refer to it
        * ``over`` ("initial" or "terminal" or "integral", or table an aggregate with aggregate, sharpness, size, times, normalized, continuous): value at the start, at the end, integral, or an aggregate
        * ``cable`` (text): name of a cable
        * ``young`` (number or formula): Young's modulus [N/m2]
        * ``distance`` (number or formula): of the outer fibres from the axis [m]
        """
