// What must fit together in a scene, beyond each key for itself. Needs neither mesh nor particles.
#pragma once

#include "proto/scene/findings.hpp"
#include "proto/scene/scene.hpp"

namespace fluxpact {

/// Adds a finding for each contradiction. Values for which something was found already are left
/// alone.
void check_scene(const Scene& scene, Findings& findings);

/// The part of it for fluid.scalars and fluid.turbulence.
void check_scalars(const Scene& scene, Findings& findings);

/// The part of it for particles.surfaces.
void check_surfaces(const Scene& scene, Findings& findings);
/// The part of it for the contact laws: which keys they need, and which have no meaning with them.
void check_contact_laws(const Scene& scene, Findings& findings);
/// The part of it for what the engine of the particles cannot do.
void check_backend(const Scene& scene, Findings& findings);
void check_yade(const Scene& scene, Findings& findings);
/// The part of it for interphase.drag_expression.
void check_drag(const Scene& scene, Findings& findings);
/// The part of it for particles.insertion, inflow and outflow.
void check_insertion(const Scene& scene, Findings& findings);

}  // namespace fluxpact
