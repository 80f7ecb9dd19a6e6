// A square plate of side 2 with a round hole of radius 0.5 in its middle, in two halves; the files beside were made of it by
//   gmsh -2 plate.geo -setnumber order 2 -setnumber recombined 1 -o NAME.msh
// with these numbers, and -bin for binary ones.
DefineConstant[ order = 1, recombined = 1, incomplete = 0 ];
Mesh.ElementOrder = order;
Mesh.SecondOrderIncomplete = incomplete;
Mesh.MeshSizeMin = 0.6;
r = 0.5;
Point(1) = {-1, -1, 0}; Point(2) = {0, -1, 0}; Point(3) = {1, -1, 0};
Point(4) = {1, 1, 0}; Point(5) = {0, 1, 0}; Point(6) = {-1, 1, 0};
Point(7) = {0, 0, 0}; Point(8) = {0, -r, 0}; Point(9) = {r, 0, 0}; Point(10) = {0, r, 0}; Point(11) = {-r, 0, 0};
Line(1) = {1, 2}; Line(2) = {2, 3}; Line(3) = {3, 4}; Line(4) = {4, 5}; Line(5) = {5, 6}; Line(6) = {6, 1};
Line(7) = {2, 8}; Line(8) = {10, 5};
Circle(9) = {8, 7, 9}; Circle(10) = {9, 7, 10}; Circle(11) = {10, 7, 11}; Circle(12) = {11, 7, 8};
Curve Loop(1) = {2, 3, 4, -8, -10, -9, -7}; Plane Surface(1) = {1};
Curve Loop(2) = {1, 7, -12, -11, 8, 5, 6}; Plane Surface(2) = {2};
Transfinite Curve {1, 2, 4, 5, 7, 8} = 2; Transfinite Curve {3, 6} = 3; Transfinite Curve {9, 10, 11, 12} = 3;
If (recombined) Recombine Surface {1, 2}; EndIf
Physical Surface("right half", 1) = {1};
Physical Surface("left half", 2) = {2};
Physical Surface(3) = {1, 2};
Physical Curve("hole") = {9, 10, 11, 12};
Physical Curve("left edge") = {6};
Physical Point("corner") = {4};
