// The one table of all keys of a scene: name, unit, allowed range, meaning. The members' initial
// values are the defaults.
//
// `describe(visit, section)` calls `visit(key, member)` for each key of a section. Visitors read
// (reader.cpp), write (writer.cpp) and document (reference.cpp) the scene, so that these can never
// disagree.
#pragma once

#include "proto/scene/key.hpp"
#include "proto/scene/scene.hpp"
#include "proto/scene/schema_fluid.hpp"
#include "proto/scene/schema_particles.hpp"

namespace fluxpact {

template <class Visit>
void describe(Visit& visit, SceneSettings& scene) {
  visit({.name = "name",
         .text = TextRule::name,
         .required = true,
         .meaning = "Names the run in all its records."},
        scene.name);
  visit({.name = "gravity",
         .dimension = Dimension::acceleration,
         .meaning = "Acceleration of gravity."},
        scene.gravity);
  visit({.name = "end_time",
         .dimension = Dimension::time,
         .range = positive,
         .required = true,
         .meaning = "Physical time to reach, from 0: a whole number of coupling windows."},
        scene.end_time);
}

template <class Visit>
void describe(Visit& visit, AuditSettings& audit) {
  visit({.name = "limit",
         .range = positive,
         .meaning =
             "Largest accepted relative imbalance of mass, global and of any cell, in a window."},
        audit.limit);
  visit({.name = "on_violation",
         .meaning =
             "`stop` ends the run at the last committed window; `warn` records it and goes on."},
        audit.on_violation);
}

template <class Visit>
void describe(Visit& visit, CouplingSettings& coupling) {
  visit({.name = "window",
         .dimension = Dimension::time,
         .range = positive,
         .required = true,
         .meaning = "Length of one fluid step and one exchange."},
        coupling.window);
  visit({.name = "scheme",
         .meaning = "`serial`: particles advance with the committed fluid, then the fluid with the "
                    "new voidage. `parallel`: both advance at once, the fluid with the voidage of "
                    "the window's start: faster, conservative all the same, one window late."},
        coupling.scheme);
  visit({.name = "continuity",
         .meaning = "`conservative`: superficial face fluxes balance the change of voidage in "
                    "every cell. `legacy`: lagged "
                    "mass source, which loses mass; for comparison only."},
        coupling.continuity);
  visit({.name = "audit", .meaning = "The gate after every window."}, coupling.audit);
}

template <class Visit>
void describe(Visit& visit, EverySettings& record) {
  visit({.name = "every",
         .dimension = Dimension::time,
         .range = not_negative,
         .meaning = "Time between two records; 0: only start and end."},
        record.every);
}

template <class Visit>
void describe(Visit& visit, OutputSettings& output) {
  visit({.name = "directory",
         .otherwise = "runs/ and the scene's name",
         .meaning = "Where the results go."},
        output.directory);
  visit({.name = "fields", .meaning = "Record of the fluid's cells and faces."}, output.fields);
  visit({.name = "particles", .meaning = "Record of the particles."}, output.particles);
}

template <class Visit>
void describe(Visit& visit, LaunchSettings& launch) {
  visit({.name = "mode",
         .meaning = "`local`: the coordinator starts its participants. `external`: it waits for "
                    "them to connect."},
        launch.mode);
  visit({.name = "listen",
         .otherwise = "a private ipc:// socket",
         .meaning = "Endpoint of the coordinator, tcp://host:port or ipc://path. Off loopback only "
                    "with `security`."},
        launch.listen);
  visit({.name = "security",
         .otherwise = "not set",
         .meaning = "`none`: written out, it allows to listen off loopback, where anybody can "
                    "connect and read."},
        launch.security);
  visit({.name = "deadline",
         .dimension = Dimension::time,
         .range = positive,
         .meaning = "Silence of a participant after which it counts as lost."},
        launch.deadline);
  visit({.name = "start_deadline",
         .dimension = Dimension::time,
         .range = positive,
         .meaning = "Time for all participants to say hello."},
        launch.start_deadline);
}

template <class Visit>
void describe(Visit& visit, Scene& scene) {
  visit({.name = "version",
         .range = {.lower = 1, .upper = 1},
         .required = true,
         .meaning = "Of this format."},
        scene.version);
  visit({.name = "scene", .required = true, .meaning = "Name, gravity, and how long."},
        scene.scene);
  visit({.name = "coupling",
         .required = true,
         .meaning = "How fluid and particles advance together."},
        scene.coupling);
  visit({.name = "fluid",
         .required = true,
         .meaning = "The fluid, its mesh and boundary conditions."},
        scene.fluid);
  visit({.name = "particles", .meaning = "The particles; without them the fluid is alone."},
        scene.particles);
  visit({.name = "interphase", .meaning = "What passes between fluid and particles."},
        scene.interphase);
  visit({.name = "output", .meaning = "What is recorded."}, scene.output);
  visit({.name = "launch", .meaning = "How the participants find each other."}, scene.launch);
}

/// A struct of the scene that `describe` knows.
struct AnyVisitor {
  template <class T>
  void operator()(const Key& /*key*/, T& /*member*/) const {}
};
template <class T>
concept Section = requires(AnyVisitor& visit, T& section) {
  describe(visit, section);
};

}  // namespace fluxpact
