// Two cubes that share a face, filled with tetrahedra; in centimetres.
SetFactory("OpenCASCADE");
Box(1) = {0, 0, 0, 1, 1, 1};
Box(2) = {0, 0, 1, 1, 1, 1};
Coherence;
MeshSize{:} = 0.45;
Physical Volume("lower") = {1};
Physical Volume("upper") = {2};
Physical Surface("inlet") = Surface In BoundingBox{-1, -1, -0.1, 2, 2, 0.1};
Physical Surface("outlet") = Surface In BoundingBox{-1, -1, 1.9, 2, 2, 2.1};
