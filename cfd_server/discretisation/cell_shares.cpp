#include "cfd_server/discretisation/cell_shares.hpp"

#include <cstdint>

namespace fluxpact {

std::vector<CellShare> share_cells(int cells, int threads, std::span<const int> owner,
                                   std::span<const int> neighbour) {
  std::vector<CellShare> shares(static_cast<std::size_t>(threads));
  for (int i = 0; i < threads; ++i) {
    CellShare& share = shares[static_cast<std::size_t>(i)];
    share.first = static_cast<int>(std::int64_t{cells} * i / threads);
    share.last = static_cast<int>(std::int64_t{cells} * (i + 1) / threads);
    share.all = threads == 1;
    if (share.all) continue;
    for (std::size_t f = 0; f < owner.size(); ++f) {
      if (share.has(owner[f]) || (f < neighbour.size() && share.has(neighbour[f])))
        share.faces.push_back(static_cast<int>(f));
    }
    share.faces.shrink_to_fit();
  }
  return shares;
}

}  // namespace fluxpact
