// The reader and writer of a table that stages hand on: RUNCERT_FUZZ_READ and RUNCERT_FUZZ_WRITE.

#include "core/failure.h"
#include "fuzz_target.h"
#include "schemas/observations/observations.h"
#include "schemas/screened/screened.h"
#include "schemas/trajectory/trajectory.h"

namespace runcert::fuzz {

void read_input(std::string_view bytes) {
    const auto table = RUNCERT_FUZZ_READ(bytes, "table");
    std::string text;
    try {
        text = RUNCERT_FUZZ_WRITE(table);
    } catch (const Failure&) {
        return;  // figures that are read, but no program of ours writes
    }
    try {
        require(RUNCERT_FUZZ_WRITE(RUNCERT_FUZZ_READ(text, "table")) == text,
                "written, read and written again: equal");
    } catch (const Failure& failure) {
        throw std::logic_error(std::string("what was written is not read: ") + failure.what());
    }
}

}  // namespace runcert::fuzz
