#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <optional>
#include <vector>

#include "core/gps_time.h"
#include "schemas/attempt/attempt.h"
#include "schemas/observations/observations.h"
#include "stages/import/osnma/chain.h"
#include "stages/import/osnma/inav_page.h"

namespace runcert::osnma {

/// The public keys that the program knows, and those that the attempt gives. Failure where one is
/// no key on P-256, or of a number that is known.
std::vector<PublicKey> public_keys(const Receiver& receiver);

/// Collects the pages of a recording, and verifies what Galileo signed of them: the orbits and
/// clocks of words 1 to 5 by tags, the tags by keys of one chain, its root by a public key
/// ([OSNMA-ICD] 6).
class PageCollector {
  public:
    /// Takes in a page; `near` is the recording's last epoch before it. Satellites are numbered
    /// from 1.
    void add(std::uint8_t satellite, const std::optional<InavPage>& page,
             std::optional<GpsTime> near);

    /// Empty where no satellite sent any signature.
    std::optional<SignedNavigation> verify(const std::vector<PublicKey>& keys) const;

  private:
    struct Received {
        std::uint8_t satellite = 0;
        InavPage page;
        GpsTime near;
    };
    std::vector<Received> pages_;
    std::int64_t damaged_ = 0;

    friend class Verification;
};

}  // namespace runcert::osnma
