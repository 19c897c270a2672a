// A cylinder of 40 mm with a gas space of 6 mm below z = 0, in millimetres: quadrangles of some 4 mm drawn out to layers of 2 mm.
// Its 20 sides stand at the radius that gives them the area of a circle of 13.85 mm: 13.85 sqrt(pi / (10 sin(pi / 10))).
// gmsh -3 cylinder.geo -format msh41 -o cylinder.msh
SetFactory("OpenCASCADE");
Disk(1) = {0, 0, -6, 13.85 * Sqrt(Pi / (10 * Sin(Pi / 10)))};
Transfinite Curve{1} = 21;
MeshSize{:} = 4.4;
Recombine Surface {1};
out[] = Extrude {0, 0, 40} { Surface{1}; Layers{{3, 17}, {6 / 40, 1}}; Recombine; };
Physical Volume("gas") = {out[1]};
Physical Surface("inlet") = {1};
Physical Surface("outlet") = {out[0]};
Physical Surface("wall") = {out[2]};
