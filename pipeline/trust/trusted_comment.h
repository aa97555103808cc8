#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "files/utc_second.h"
#include "trust/signature.h"

namespace runcert {

/// What a signer of a report states along with the signature, and signs too:
/// "runcert report=REPORT_ID attempt=ID role=ROLE key=RW... signed=2026-11-21T20:41:50Z".
struct TrustedComment {
    std::string report_id{};
    std::string attempt_id{};
    std::string role{};
    std::string key{};  ///< the signer's public key as `minisign -P` takes it
    std::string signed_at{};
    std::string recomputed{};  ///< "no" where the signer left the recomputation out; else empty
    std::string repeated{};    ///< a field that is there twice, of which programs read one each
};

std::string trusted_comment_text(const TrustedComment& comment);

/// What a trusted comment states; fields that are not there stay empty, as all do of a comment that
/// is not of this form.
TrustedComment parse_trusted_comment(std::string_view text);

}  // namespace runcert
