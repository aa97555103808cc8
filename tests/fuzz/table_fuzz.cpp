// The reader and writer of a table that stages hand on: RUNCERT_FUZZ_READ and RUNCERT_FUZZ_WRITE.

#include "fuzz_target.h"
#include "schemas/observations/observations.h"
#include "schemas/screened/screened.h"
#include "schemas/trajectory/declared.h"

namespace runcert::fuzz {

void read_input(std::string_view bytes) {
    read_and_write(bytes, RUNCERT_FUZZ_READ, RUNCERT_FUZZ_WRITE);
}

}  // namespace runcert::fuzz
