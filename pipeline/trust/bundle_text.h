#pragma once

#include <string>
#include <vector>

namespace runcert {

/// What VERIFY.txt says of one bundle.
struct BundleFacts {
    std::string attempt;
    std::string report_id;
    std::vector<std::string> files;  ///< in the bundle, sorted, without VERIFY.txt and SHA256SUMS
};

/// VERIFY.txt: how a stranger checks the bundle, with runcert and without.
std::string bundle_text(const BundleFacts& facts);

}  // namespace runcert
