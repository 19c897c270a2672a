#include "coordinator/audit/scalar_ledger.hpp"

#include <algorithm>
#include <cmath>

#include "proto/base/compensated_sum.hpp"

namespace fluxpact {
namespace {

struct Amount {
  double sum = 0;   ///< Σ ρ ε V c
  double size = 0;  ///< Σ ρ ε V |c|
};

Amount amount_of(const Mesh& mesh, const ScalarWindow& window, std::span<const double> voidage,
                 std::span<const double> value) {
  CompensatedSum sum;
  CompensatedSum size;
  for (std::size_t c = 0; c < mesh.cell_volumes.size(); ++c) {
    const double part =
        window.factor * window.density * voidage[c] * mesh.cell_volumes[c] * value[c];
    sum.add(part);
    size.add(std::abs(part));
  }
  return {sum.value(), size.value()};
}

}  // namespace

ScalarAudit audit_scalar(const Mesh& mesh, const ScalarWindow& window) {
  const Amount before = amount_of(mesh, window, window.voidage_before, window.value_before);
  const Amount after = amount_of(mesh, window, window.voidage_after, window.value_after);
  CompensatedSum in;
  CompensatedSum out;
  for (const double flux : window.boundary_flux) {
    if (flux < 0) {
      in.add(-flux);
    } else {
      out.add(flux);
    }
  }
  ScalarAudit audit;
  audit.amount = after.sum;
  audit.in = in.value();
  audit.out = out.value();
  audit.source = window.source;
  const double net = (audit.in - audit.out + audit.source) * window.length;
  const double error = net - (after.sum - before.sum);
  const double size = std::max({before.size, after.size, audit.in * window.length});
  // Nothing is there and nothing came: there is nothing to be wrong about.
  audit.imbalance = error == 0 ? 0.0 : error / size;
  const auto [lowest, highest] = std::ranges::minmax(window.value_after);
  audit.lowest = lowest;
  audit.highest = highest;
  return audit;
}

}  // namespace fluxpact
