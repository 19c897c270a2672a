SetFactory("OpenCASCADE");
Box(1) = {0,0,0, 1,1,1};
MeshSize{:} = 0.55;
Physical Volume("gas") = {1};
Physical Surface("inlet") = {5};
Physical Surface("outlet") = {6};
Physical Surface("sides") = {1:4};
