#include "proto/base/expression.hpp"

#include <muParser.h>

#include <numbers>
#include <string_view>

#include "proto/base/errors.hpp"

namespace fluxpact {
namespace {

// muParser lets a formula assign to its variables: in a scene `x = 0.1` can only be a slip for
// `==`.
void refuse_assignment(const std::string& text) {
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (text[i] != '=') continue;
    const bool pair = i + 1 < text.size() && text[i + 1] == '=';
    const bool compares =
        pair || (i > 0 && std::string_view("<>!").find(text[i - 1]) != std::string_view::npos);
    if (!compares) {
      throw ConfigError("formula '{}': '=' at character {} assigns; write '==' to compare", text,
                        i + 1);
    }
    if (pair) ++i;
  }
}

}  // namespace

struct Expression::Impl {
  mu::Parser parser;
  double x = 0;
  double y = 0;
  double z = 0;
  double t = 0;
};

Expression::Expression(const std::string& text) : impl_(std::make_unique<Impl>()) {
  refuse_assignment(text);
  try {
    impl_->parser.DefineVar("x", &impl_->x);
    impl_->parser.DefineVar("y", &impl_->y);
    impl_->parser.DefineVar("z", &impl_->z);
    impl_->parser.DefineVar("t", &impl_->t);
    impl_->parser.DefineConst("pi", std::numbers::pi);
    impl_->parser.SetExpr(text);
    int results = 0;
    impl_->parser.Eval(results);  // compiles: everything that can be wrong with the text shows now
    if (results != 1) {
      throw ConfigError("formula '{}' gives {} values; expected one", text, results);
    }
  } catch (const mu::Parser::exception_type& error) {
    throw ConfigError(
        "formula '{}': {} (character {}); variables are x, y, z [m] and t [s], pi is known", text,
        error.GetMsg(), error.GetPos() + 1);
  }
}

Expression::~Expression() = default;
Expression::Expression(Expression&&) noexcept = default;
Expression& Expression::operator=(Expression&&) noexcept = default;

double Expression::operator()(const Vector3& position, double time) const {
  impl_->x = position.x();
  impl_->y = position.y();
  impl_->z = position.z();
  impl_->t = time;
  return impl_->parser.Eval();
}

}  // namespace fluxpact
