// What a participant sent is looked at before anybody uses it.
#pragma once

#include "proto/mesh/mesh.hpp"
#include "proto/message/message.hpp"
#include "proto/scene/scene.hpp"

namespace fluxpact {

/// Throws ProtocolError if a field is missing or mis-shaped, NumericsError naming field, cell and
/// value if one is not finite, or a voidage outside (0, 1].
void check_particle_fields(const Message& result, const Scene& scene, const Mesh& mesh,
                           std::int64_t step);
/// The same of an offer, what the particles let the fluid meet.
void check_offer_fields(const Message& result, const Scene& scene, const Mesh& mesh,
                        std::int64_t step);
void check_fluid_fields(const Message& result, const Scene& scene, const Mesh& mesh,
                        std::int64_t step);

}  // namespace fluxpact
