// The keys of the walls that a scene adds for its particles: a part of the table of schema.hpp.
#pragma once

#include "proto/scene/key.hpp"
#include "proto/scene/scene.hpp"

namespace fluxpact {

template <class Visit>
void describe(Visit& visit, MotionSettings& motion) {
  visit({.name = "type",
         .required = true,
         .meaning = "Rigid motion of the surface, from its place at time 0: along a line, about "
                    "an axis, or to and fro about that place."},
        motion.type);
  const bool translation = motion.type == MotionType::translation;
  const bool rotation = motion.type == MotionType::rotation;
  const bool vibration = motion.type == MotionType::vibration;
  visit({.name = "velocity",
         .dimension = Dimension::velocity,
         .required = true,
         .applies = translation,
         .only_with = "type: translation",
         .meaning = "Of the surface."},
        motion.velocity);
  visit({.name = "point",
         .dimension = Dimension::length,
         .required = true,
         .applies = rotation,
         .only_with = "type: rotation",
         .meaning = "A point of the axis."},
        motion.point);
  visit({.name = "direction",
         .required = true,
         .applies = rotation,
         .only_with = "type: rotation",
         .meaning = "Direction of the axis; its length is of no account."},
        motion.direction);
  visit({.name = "rate",
         .dimension = Dimension::angular_velocity,
         .required = true,
         .applies = rotation,
         .only_with = "type: rotation",
         .meaning = "Angular velocity, right-handed about `direction`."},
        motion.rate);
  visit({.name = "amplitude",
         .dimension = Dimension::length,
         .required = true,
         .applies = vibration,
         .only_with = "type: vibration",
         .meaning = "Displacement is amplitude times sin(2 pi frequency t + phase)."},
        motion.amplitude);
  visit({.name = "frequency",
         .dimension = Dimension::frequency,
         .range = positive,
         .required = true,
         .applies = vibration,
         .only_with = "type: vibration",
         .meaning = "Of the vibration."},
        motion.frequency);
  visit({.name = "phase",
         .applies = vibration,
         .only_with = "type: vibration",
         .meaning = "Of the vibration at time 0 (rad)."},
        motion.phase);
}

template <class Visit>
void describe(Visit& visit, SurfaceSettings& surface) {
  visit({.name = "type",
         .required = true,
         .meaning = "`plane`: endless, solid behind it; `cylinder` and `cone`: a shell without "
                    "ends about an axis; `stl`: triangles of a file. All but the plane have two "
                    "sides, and a particle stays on the one from which it came."},
        surface.type);
  const bool plane = surface.type == SurfaceType::plane;
  const bool cone = surface.type == SurfaceType::cone;
  const bool stl = surface.type == SurfaceType::stl;
  const bool round = cone || surface.type == SurfaceType::cylinder;
  visit({.name = "material",
         .text = TextRule::name,
         .otherwise = "`walls`",
         .meaning = "One of `particles.materials`, or `walls`: chooses the contact law."},
        surface.material);
  visit({.name = "point",
         .dimension = Dimension::length,
         .required = true,
         .applies = !stl,
         .only_with = "type: plane | cylinder | cone",
         .meaning = "Of the plane, or where the axis starts."},
        surface.point);
  visit({.name = "normal",
         .required = true,
         .applies = plane,
         .only_with = "type: plane",
         .meaning = "To the side where the particles are; its length is of no account."},
        surface.normal);
  visit({.name = "direction",
         .required = true,
         .applies = round,
         .only_with = "type: cylinder | cone",
         .meaning = "Of the axis; its length is of no account."},
        surface.direction);
  visit({.name = "radius",
         .dimension = Dimension::length,
         .range = cone ? not_negative : positive,
         .required = true,
         .applies = round,
         .only_with = "type: cylinder | cone",
         .meaning = "Of the cylinder, or of the cone at `point`, where it may be 0."},
        surface.radius);
  visit({.name = "end_radius",
         .dimension = Dimension::length,
         .range = not_negative,
         .required = true,
         .applies = cone,
         .only_with = "type: cone",
         .meaning = "Of the cone at `point` + `length` along `direction`."},
        surface.end_radius);
  visit({.name = "length",
         .dimension = Dimension::length,
         .range = positive,
         .required = cone,
         .otherwise = "an endless cylinder; a cone needs it",
         .applies = round,
         .only_with = "type: cylinder | cone",
         .meaning = "Along the axis."},
        surface.length);
  visit({.name = "side",
         .applies = !plane,
         .only_with = "type: cylinder | cone | stl",
         .meaning = "Where the insertion may place particles. Inside of a file is where its "
                    "triangles, right-handed, point away from; it must be closed."},
        surface.side);
  visit({.name = "path",
         .required = true,
         .applies = stl,
         .only_with = "type: stl",
         .meaning = "STL, ascii or binary; relative to the folder of the scene."},
        surface.path);
  visit({.name = "scale",
         .dimension = Dimension::length,
         .range = positive,
         .applies = stl,
         .only_with = "type: stl",
         .meaning = "Length of one unit of the file."},
        surface.scale);
  visit({.name = "motion", .otherwise = "at rest", .meaning = "How the surface moves."},
        surface.motion);
}

}  // namespace fluxpact
