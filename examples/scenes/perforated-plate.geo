// A plate of 400 x 240 mm with a round hole of 120 mm: quadrilaterals of nine nodes by `gmsh -2 -format msh2 perforated-plate.geo`.
a = 0.4; b = 0.12; r = 0.06;
Point(1) = {0, -b, 0}; Point(2) = {a, -b, 0}; Point(3) = {a, b, 0}; Point(4) = {0, b, 0};
Point(5) = {0.2, 0, 0};
s = r / Sqrt(2);
Point(6) = {0.2 - s, -s, 0}; Point(7) = {0.2 + s, -s, 0}; Point(8) = {0.2 + s, s, 0}; Point(9) = {0.2 - s, s, 0};
For k In {1:4}
  Line(k) = {k, k % 4 + 1};
  Circle(4 + k) = {5 + k, 5, 5 + k % 4 + 1};
  Line(8 + k) = {k, 5 + k};
EndFor
For k In {1:4}
  Curve Loop(k) = {k, 8 + k % 4 + 1, -(4 + k), -(8 + k)};
  Plane Surface(k) = {k};
EndFor
Transfinite Curve {1:8} = 5;
Transfinite Curve {9:12} = 4;
Transfinite Surface {1:4};
Recombine Surface {1:4};
Physical Surface("plate") = {1:4};
Physical Curve("hinge") = {4};
Physical Curve("free edge") = {2};
Mesh.ElementOrder = 2;
