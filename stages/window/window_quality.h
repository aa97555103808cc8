#pragma once

#include <cstdint>
#include <vector>

#include "schemas/profile/profile.h"
#include "schemas/screened/screened.h"
#include "stages/window/best_window.h"
#include "witness/certifiable.h"

namespace runcert {

/// What the uncertainties of a rule's windows differ by, beside their lengths.
struct WindowQuality {
    /// Root mean square of the accuracy that its epochs state, or of the floor of their fix types.
    double stated = 0.0;
    double missed = 0.0;  ///< the same of the largest errors that the tests of its epochs miss
    std::uint64_t witnesses = 0;  ///< a bit for each that covers it, set by the caller
    bool silent = false;          ///< an epoch states no accuracy of the recorded speed

    /// Whether nothing of it is better, by more than a tenth, than another window has it.
    bool no_better_than(const WindowQuality& other) const;
};

/// The qualities of a recording's windows under a profile. Set-up is linear, and a window then
/// costs the same whatever its length.
class WindowQualities {
  public:
    WindowQualities(const ScreenedTable& screened, const std::vector<ArcRows>& arcs,
                    const Profile& profile);

    WindowQuality operator()(const FoundWindow& found) const;

  private:
    struct Sums {
        double stated = 0.0, missed = 0.0;  ///< squares
        std::int64_t usable = 0, silent = 0;
    };

    const std::vector<ArcRows>& arcs_;
    std::vector<Sums> sums_;  ///< of the rows before each
};

}  // namespace runcert
