// results.xdmf: tells ParaView what in results.h5 is mesh, field and particle, and when.
//
// One temporal collection of the mesh with its cell fields, one of the particles. What readers ask
// for (tried with ParaView 5.11): every DataItem carries Format, NumberType and Precision, or the
// Xdmf3 reader aborts; fields of a box grid have its three dimensions here though the dataset is
// flat, or the classic reader takes the first plane for the whole. Box meshes are drawn as
// rectilinear grids, by both readers; others as polyhedra, by the Xdmf3 reader only.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "proto/mesh/mesh.hpp"

namespace fluxpact {

/// A dataset of reals or whole numbers in results.h5, one row a cell or particle.
struct XdmfField {
  std::string name;
  std::string dataset;         ///< path inside the file
  std::size_t components = 1;  ///< 1 or 3
  bool whole = false;          ///< 64-bit whole numbers instead of reals
};

/// The cells of a mesh that is no box grid, as XDMF wants them: for each cell 16, the number of its
/// faces, and for each face the number of its points and their indices.
struct XdmfPolyhedra {
  std::vector<Vector3>
      points;  ///< [m] those of the mesh, then copies on the far side of periodic faces
  std::vector<std::int32_t> connectivity;
};

XdmfPolyhedra draw_polyhedra(const Mesh& mesh);

/// Where the shape of the mesh stands in results.h5.
namespace drawn {
inline constexpr auto node_lists =
    std::to_array<const char*>({"/mesh/lattice_x", "/mesh/lattice_y", "/mesh/lattice_z"});
inline constexpr auto points = "/mesh/polyhedron_points";
inline constexpr auto connectivity = "/mesh/polyhedron_connectivity";
}  // namespace drawn

/// Gathers what was recorded and gives the text of the whole file.
class XdmfIndex {
 public:
  /// `file` is the name of the HDF5 file beside this one.
  XdmfIndex(std::string file, const Lattice& lattice);
  XdmfIndex(std::string file, int cells, const XdmfPolyhedra& polyhedra);

  void add_fields(double time, const std::vector<XdmfField>& fields);
  void add_particles(double time, std::size_t count, const std::string& positions,
                     const std::vector<XdmfField>& fields);
  std::string text() const;

 private:
  std::string file_;
  std::string mesh_;        ///< topology and geometry, the same for all times
  std::string cell_shape_;  ///< of a cell field, without its components
  std::string mesh_times_;
  std::string particle_times_;
};

}  // namespace fluxpact
