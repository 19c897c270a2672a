#include "proto/base/version.hpp"

#include <H5public.h>
#include <fmt/format.h>
#include <zmq.h>
#include <msgpack/version_master.hpp>

#include <Eigen/Core>

#include "fluxpact_revision.hpp"

namespace fluxpact {

std::string version_line() {
  return fmt::format("fluxpact {} ({})", FLUXPACT_VERSION, FLUXPACT_REVISION);
}

std::string version_text() {
  int major = 0;
  int minor = 0;
  int patch = 0;
  zmq_version(&major, &minor, &patch);
  return fmt::format(
      "{}\ncompiler  {}\nEigen     {}.{}.{}\nZeroMQ    {}.{}.{}\nmsgpack   {}.{}.{}\nHDF5      "
      "{}.{}.{}\n",
      version_line(), __VERSION__, EIGEN_WORLD_VERSION, EIGEN_MAJOR_VERSION, EIGEN_MINOR_VERSION,
      major, minor, patch, MSGPACK_VERSION_MAJOR, MSGPACK_VERSION_MINOR, MSGPACK_VERSION_REVISION,
      H5_VERS_MAJOR, H5_VERS_MINOR, H5_VERS_RELEASE);
}

}  // namespace fluxpact
