// The keys of particles at the start and of those that come in: a part of the table of schema.hpp.
#pragma once

#include "proto/scene/key.hpp"
#include "proto/scene/scene.hpp"

namespace fluxpact {

template <class Visit>
void describe(Visit& visit, SizeSettings& sizes) {
  visit(
      {.name = "distribution",
       .meaning = "`table`: some diameters; the others are densities between the ends of `range`, "
                  "which cut them off."},
      sizes.distribution);
  const bool table = sizes.distribution == SizeDistribution::table;
  const bool curve = sizes.distribution == SizeDistribution::normal ||
                     sizes.distribution == SizeDistribution::lognormal;
  visit({.name = "by",
         .meaning = "What the weights or the density share out: the `number` or the `mass` of the "
                    "spheres."},
        sizes.by);
  visit({.name = "table",
         .range = positive,
         .required = true,
         .applies = table,
         .only_with = "distribution: table",
         .meaning = "Pairs of diameter (m) and weight, the diameters ascending, e.g. "
                    "[[0.8e-3, 1], [1e-3, 2]]. The weights need not add up to 1."},
        sizes.table);
  visit(
      {.name = "mean",
       .dimension = Dimension::length,
       .range = positive,
       .required = true,
       .applies = curve,
       .only_with = "distribution: normal | lognormal",
       .meaning = "Mean of the normal distribution, median of the lognormal one, before the cut."},
      sizes.mean);
  visit({.name = "deviation",
         .range = positive,
         .required = true,
         .applies = curve,
         .only_with = "distribution: normal | lognormal",
         .meaning = "Standard deviation over `mean` of the normal distribution, that of the "
                    "logarithm of the diameter of the lognormal one."},
        sizes.deviation);
  visit({.name = "range",
         .dimension = Dimension::length,
         .range = positive,
         .required = true,
         .applies = !table,
         .only_with = "distribution: uniform | normal | lognormal",
         .meaning = "Smallest and largest diameter."},
        sizes.range);
}

/// How many spheres a random packing or a settled bed has.
template <class Visit>
void describe_amount(Visit& visit, InsertionSettings& entry, bool applies) {
  visit({.name = "count",
         .range = {.lower = 1},
         .otherwise = "one of `fraction`, `number_density`, `height`",
         .applies = applies,
         .only_with = "type: packing | settled",
         .meaning = "Number of spheres."},
        entry.count);
  visit({.name = "fraction",
         .range = {.lower = 0, .upper = 0.74, .without_lower = true},
         .otherwise = "not set",
         .applies = applies,
         .only_with = "type: packing | settled",
         .meaning = "Their volume over that of `within`, in place of `count`. A random packing "
                    "reaches some 0.60."},
        entry.fraction);
  visit({.name = "number_density",
         .range = positive,
         .otherwise = "not set",
         .applies = applies,
         .only_with = "type: packing | settled",
         .meaning = "Their number per volume of `within`, 1/m3, in place of `count`."},
        entry.number_density);
}

template <class Visit>
void describe(Visit& visit, InsertionSettings& entry) {
  visit({.name = "type",
         .required = true,
         .meaning = "`packing`: spheres at random; `settled`: a bed that has come to rest under "
                    "gravity; `lattice`: a region filled with a regular lattice; `file`: read."},
        entry.type);
  const bool settled = entry.type == InsertionType::settled;
  const bool random = entry.type == InsertionType::packing || settled;
  const bool file = entry.type == InsertionType::file;
  visit({.name = "material",
         .text = TextRule::name,
         .required = true,
         .meaning = "One of `particles.materials`."},
        entry.material);
  visit({.name = "diameter",
         .dimension = Dimension::length,
         .range = positive,
         .otherwise = "`sizes`, or the file's own, which win",
         .meaning = "Of all spheres. Required with `type: lattice`; in place of `sizes` with "
                    "`packing` and `settled`."},
        entry.diameter);
  visit({.name = "sizes",
         .otherwise = "`diameter`",
         .applies = random,
         .only_with = "type: packing | settled",
         .meaning = "Spheres of several diameters."},
        entry.sizes);
  describe_amount(visit, entry, random);
  visit({.name = "height",
         .dimension = Dimension::length,
         .range = positive,
         .otherwise = "not set",
         .applies = settled,
         .only_with = "type: settled",
         .meaning = "Of the settled bed above the bottom of `within`, in place of `count`: what "
                    "sticks out above is taken away."},
        entry.height);
  visit({.name = "within",
         .otherwise = "the whole domain",
         .applies = !file,
         .only_with = "type: packing | settled | lattice",
         .meaning = "Where the spheres start; the loose packing from which a bed settles too."},
        entry.within);
  visit({.name = "seed",
         .range = not_negative,
         .applies = random,
         .only_with = "type: packing | settled",
         .meaning = "Of the random numbers: the same seed gives the same spheres."},
        entry.seed);
  visit({.name = "spacing",
         .dimension = Dimension::length,
         .range = positive,
         .otherwise = "1.001 diameters",
         .applies = entry.type == InsertionType::lattice,
         .only_with = "type: lattice",
         .meaning = "Distance of neighbours."},
        entry.spacing);
  visit(
      {.name = "motion",
       .meaning = "`fixed`: the spheres stay where they are at time 0, whatever acts on them, and "
                  "do not turn: free ones bounce off them, the fluid flows around them. They "
                  "touch neither each other nor walls."},
      entry.motion);
  visit({.name = "velocity",
         .dimension = Dimension::velocity,
         .applies = !file && !settled && entry.motion == Mobility::free,
         .only_with = "type: packing | lattice, motion: free",
         .meaning = "Of all spheres at the start."},
        entry.velocity);
  visit({.name = "path",
         .required = true,
         .applies = file,
         .only_with = "type: file",
         .meaning = "CSV with a header line, HDF5, or a text dump of LAMMPS or LIGGGHTS (its last "
                    "frame), in SI units: docs/insertion.md. Relative to the folder of the scene."},
        entry.path);
  visit({.name = "group",
         .otherwise = "the top, or the last record of a results.h5",
         .applies = file,
         .only_with = "type: file",
         .meaning = "Where the datasets stand in an HDF5 file, e.g. /particles/000003."},
        entry.group);
}

template <class Visit>
void describe(Visit& visit, InflowSettings& inflow) {
  visit({.name = "patch",
         .text = TextRule::name,
         .otherwise = "`within`",
         .meaning = "Patch of the fluid's mesh through whose faces the particles come, evenly over "
                    "its area."},
        inflow.patch);
  visit({.name = "within",
         .otherwise = "`patch`",
         .meaning = "Box in which the particles appear, evenly over its volume."},
        inflow.within);
  visit({.name = "material",
         .text = TextRule::name,
         .required = true,
         .meaning = "One of `particles.materials`."},
        inflow.material);
  visit({.name = "diameter",
         .dimension = Dimension::length,
         .range = positive,
         .otherwise = "`sizes`",
         .meaning = "Of all spheres."},
        inflow.diameter);
  visit({.name = "sizes", .otherwise = "`diameter`", .meaning = "Spheres of several diameters."},
        inflow.sizes);
  visit({.name = "mass_rate",
         .dimension = Dimension::mass_flow,
         .range = positive,
         .otherwise = "`number_rate`",
         .meaning = "Mean rate: what is no whole particle waits for a later window."},
        inflow.mass_rate);
  visit({.name = "number_rate",
         .range = positive,
         .otherwise = "`mass_rate`",
         .meaning = "The same in particles per second, 1/s."},
        inflow.number_rate);
  visit({.name = "velocity",
         .dimension = Dimension::velocity,
         .meaning = "Of each particle as it comes in."},
        inflow.velocity);
  visit({.name = "start",
         .dimension = Dimension::time,
         .range = not_negative,
         .meaning = "When the flow begins."},
        inflow.start);
  visit({.name = "stop",
         .dimension = Dimension::time,
         .range = positive,
         .otherwise = "never",
         .meaning = "When the flow ends."},
        inflow.stop);
  visit({.name = "seed",
         .range = not_negative,
         .meaning = "Of the random numbers: the same seed gives the same particles."},
        inflow.seed);
}

}  // namespace fluxpact
