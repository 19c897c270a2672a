// A pipe of 50 mm diameter and 150 mm length, in millimetres: quadrangles drawn out to hexahedra, twice as thin in the lower 50 mm.
// gmsh -3 pipe.geo -format msh41 -o pipe.msh
SetFactory("OpenCASCADE");
Disk(1) = {0, 0, 0, 25};
MeshSize{:} = 7;
Recombine Surface {1};
out[] = Extrude {0, 0, 150} { Surface{1}; Layers{{10, 10}, {1 / 3, 1}}; Recombine; };
Physical Volume("gas") = {out[1]};
Physical Surface("inlet") = {1};
Physical Surface("outlet") = {out[0]};
Physical Surface("pipe") = {out[2]};
