// The readers of recordings: the target is the format, "auto" for all by their content.

#include "fuzz_target.h"
#include "import_checks.h"

namespace runcert::fuzz {

void read_input(std::string_view bytes) {
    Receiver receiver;
    receiver.id = "primary";
    receiver.recordings = {"recording"};
    receiver.format = target_name();
    receiver.place = "attempt.yaml:5:5";
    // An attempt that states nothing, or all that may help a reader.
    if (bytes.size() % 2 == 1) {
        receiver.start_date = "2023-07-11";
        receiver.utc_offset_h = -3.5;
        receiver.height_m = 12.0;
        receiver.accuracy = {.horizontal_m = 1.5, .vertical_m = 3.0};
    }
    import_and_check(receiver, bytes);
}

}  // namespace runcert::fuzz
