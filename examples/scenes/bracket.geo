// A perforated bracket in millimetres: a tapered web with an eye at its hinge, two openings and an eye for its load, and a flange below.
//   gmsh -2 bracket.geo -o bracket.msh
SetFactory("Built-in");
size = 26;
length = 200;
// half the height at the hinge and at the load
high = 40;
low = 24;

// outline of the web; the flange stands on its lower edge
Point(1) = {-30, -high, 0, size};
Point(2) = {length + 25, -low, 0, size};
Point(3) = {length + 25, low, 0, size};
Point(4) = {-30, high, 0, size};
Line(1) = {1, 2};
Line(2) = {2, 3};
Line(3) = {3, 4};
Line(4) = {4, 1};

// a circle of a radius about a place on the x axis, in four arcs
Macro Opening
  c = newp; Point(c) = {x, 0, 0, size};
  p0 = newp; Point(p0) = {x + r, 0, 0, size};
  p1 = newp; Point(p1) = {x, r, 0, size};
  p2 = newp; Point(p2) = {x - r, 0, 0, size};
  p3 = newp; Point(p3) = {x, -r, 0, size};
  a0 = newc; Circle(a0) = {p0, c, p1};
  a1 = newc; Circle(a1) = {p1, c, p2};
  a2 = newc; Circle(a2) = {p2, c, p3};
  a3 = newc; Circle(a3) = {p3, c, p0};
  Transfinite Curve {a0, a1, a2, a3} = n;
  arcs() = {a0, a1, a2, a3};
Return

n = 3;
x = 0; r = 10;
Call Opening;
hinge() = arcs();
x = 0; r = 22;
Call Opening;
eye() = arcs();
n = 2;
x = 68; r = 18;
Call Opening;
first() = arcs();
x = 132; r = 14;
Call Opening;
second() = arcs();
x = length; r = 8;
Call Opening;
load() = arcs();

Curve Loop(1) = {1, 2, 3, 4};
Curve Loop(2) = {hinge()};
Curve Loop(3) = {eye()};
Curve Loop(4) = {first()};
Curve Loop(5) = {second()};
Curve Loop(6) = {load()};
Plane Surface(1) = {1, 3, 4, 5, 6};
Plane Surface(2) = {3, 2};
flange() = Extrude {0, 0, 30} { Curve{1}; Layers{1}; Recombine; };

Physical Surface("web") = {1};
Physical Surface("eye") = {2};
Physical Surface("flange") = {flange(1)};
Physical Curve("hinge") = {hinge()};
Physical Curve("load") = {load()};

// quadrilaterals of nine nodes, and triangles of six where they do not fit
Mesh.RecombineAll = 1;
Mesh.ElementOrder = 2;
Mesh.MshFileVersion = 4.1;
