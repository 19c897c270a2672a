// What the schema says about one key of the scene.
#pragma once

#include <string_view>

#include "proto/scene/quantity.hpp"

namespace fluxpact {

/// What a text may be.
enum class TextRule {
  free,  ///< anything printable
  name,  ///< letters, digits, `_`, `-`; not empty, no word that YAML takes for a truth value
};

struct Key {
  std::string_view name;
  Dimension dimension = Dimension::none;
  Range range = any_number;  ///< of each number of the value
  TextRule text = TextRule::free;
  bool required = false;
  std::string_view otherwise =
      {};               ///< optional keys whose initial value means "not given": what holds then
  bool applies = true;  ///< false: not with the other values of this section
  std::string_view only_with =
      {};  ///< the condition behind `applies`, for the reference and messages
  std::string_view meaning = {};
};

}  // namespace fluxpact
