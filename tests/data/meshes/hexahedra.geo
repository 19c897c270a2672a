// A cube of graded hexahedra. All is saved, so the file holds a point that no cell uses, as the
// centre of a circle would be, and the sides without a name.
Mesh.SaveAll = 1;
Point(9) = {3, 3, 3};
Point(1) = {0, 0, 0}; Point(2) = {1, 0, 0}; Point(3) = {1, 1, 0}; Point(4) = {0, 1, 0};
Line(1) = {1, 2}; Line(2) = {2, 3}; Line(3) = {3, 4}; Line(4) = {4, 1};
Curve Loop(1) = {1, 2, 3, 4}; Plane Surface(1) = {1};
Transfinite Curve {1, 3} = 4 Using Bump 0.5; Transfinite Curve {2, 4} = 3;
Transfinite Surface {1}; Recombine Surface {1};
out[] = Extrude {0, 0, 1} { Surface{1}; Layers{{1, 2}, {0.2, 1}}; Recombine; };
Physical Surface("bottom") = {1};
Physical Surface("right") = {out[3]};
Physical Surface("left") = {out[5]};
