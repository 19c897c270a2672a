#include <gtest/gtest.h>

#include <fstream>
#include <iterator>
#include <string>

#include "coordinator/audit/audit_row.hpp"

namespace fluxpact {
namespace {

TEST(AuditReference, is_the_committed_document) {
  std::ifstream file(std::string(FLUXPACT_SOURCE_DIR) + "/docs/audit-reference.md",
                     std::ios::binary);
  const std::string committed((std::istreambuf_iterator<char>(file)),
                              std::istreambuf_iterator<char>());
  EXPECT_TRUE(committed == audit_reference())
      << "docs/audit-reference.md is older than the table of columns; refresh it: coordinator "
         "reference audit > "
         "docs/audit-reference.md";
}

}  // namespace
}  // namespace fluxpact
