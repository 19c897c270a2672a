#include <algorithm>
#include <cstdint>

#include "proto/base/errors.hpp"
#include "proto/participant/participant.hpp"

namespace fluxpact {

const FieldView& Fields::find(std::string_view name, int components, int size) const {
  const auto found = std::ranges::find(views_, name, &FieldView::name);
  if (found == views_.end()) throw ProtocolError("field '{}' is missing from the message", name);
  const auto expected = static_cast<std::size_t>(components) * static_cast<std::size_t>(size);
  if (found->components != components || found->values.size() != expected) {
    throw ProtocolError("field '{}' has {} values in rows of {}; expected {} rows of {}", name,
                        found->values.size(), found->components, size, components);
  }
  return *found;
}

std::span<const double> Fields::scalars(std::string_view name, int size) const {
  return find(name, 1, size).values;
}

std::span<const Vector3> Fields::vectors(std::string_view name, int size) const {
  return as_vectors(find(name, 3, size).values);
}

double Fields::number(std::string_view name) const {
  const auto found = numbers_.find(std::string(name));
  if (found == numbers_.end()) throw ProtocolError("number '{}' is missing from the message", name);
  return found->second;
}

void Participant::offer(const Window& window, const Fields& /*in*/, Fields& /*out*/,
                        const Progress& /*progress*/) {
  throw ProtocolError(
      "asked for an offer in step {}, which this participant cannot make; set coupling.scheme: "
      "serial",
      window.step);
}

}  // namespace fluxpact
