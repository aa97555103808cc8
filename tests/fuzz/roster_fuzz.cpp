// The reader of rosters.

#include "core/failure.h"
#include "fuzz_target.h"
#include "trust/roster.h"

namespace runcert::fuzz {

void read_input(std::string_view bytes) {
    const Roster roster = parse_roster(bytes, "roster");
    require(!roster.entries.empty(), "a roster without keys is refused");
    const Roster again = parse_roster(roster.text, "roster");
    require(again.entries.size() == roster.entries.size(), "as ssh-keygen takes it: as many keys");
    for (std::size_t i = 0; i < roster.entries.size(); ++i) {
        const RosterEntry& entry = roster.entries[i];
        require(entry.key == again.entries[i].key, "as ssh-keygen takes it: the same keys");
        for (const char* role : {"measurer", "judge", "", "*"})
            require(entry.allows(role) == again.entries[i].allows(role),
                    "as ssh-keygen takes it: the same roles");
        (void)entry.is_valid_at(UtcSecond(std::chrono::seconds(1'800'000'000)));
    }
}

}  // namespace runcert::fuzz
