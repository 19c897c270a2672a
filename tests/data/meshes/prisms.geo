// A pipe of radius 1 and length 4: triangles drawn out to prisms.
SetFactory("OpenCASCADE");
Disk(1) = {0, 0, 0, 1};
MeshSize{:} = 0.7;
out[] = Extrude {0, 0, 4} { Surface{1}; Layers{4}; Recombine; };
Physical Volume("gas") = {out[1]};
Physical Surface("inlet") = {1};
Physical Surface("outlet") = {out[0]};
Physical Surface("pipe") = {out[2]};
