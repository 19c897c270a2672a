// Formulas in scenes, e.g. a voidage profile.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "proto/base/vector.hpp"

namespace fluxpact {

/// A formula in x, y, z [m] and t [s], compiled once (muParser: + - * / ^, ?:, sin, exp, tanh, min,
/// max, pi ...).
class Expression {
 public:
  /// Throws ConfigError with the place in the text if it cannot be parsed or names an unknown
  /// variable.
  explicit Expression(const std::string& text);
  ~Expression();
  Expression(Expression&&) noexcept;
  Expression& operator=(Expression&&) noexcept;

  double operator()(const Vector3& position, double time) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace fluxpact
