// Hexahedra in one cube, tetrahedra in the next, pyramids where they meet.
SetFactory("OpenCASCADE");
Box(1) = {0, 0, 0, 1, 1, 1};
Box(2) = {1, 0, 0, 1, 1, 1};
Coherence;
Transfinite Curve {:} = 3;
Transfinite Surface {1:6}; Recombine Surface {1:6};
Transfinite Volume {1};
Physical Volume("left") = {1};
Physical Volume("right") = {2};
