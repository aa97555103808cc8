// What openssl and pdfsig say of files that others made: the readers of their words.

#include "core/failure.h"
#include "fuzz_target.h"
#include "trust/seal.h"
#include "trust/time_stamp.h"

namespace runcert::fuzz {

void read_input(std::string_view bytes) {
    if (const auto stamp = stamp_from_words(bytes)) {
        require(!stamp->hash.imprint.empty() &&
                    stamp->hash.imprint.find_first_not_of("0123456789abcdef") == std::string::npos,
                "an imprint of hexadecimal digits");
        require(parse_iso_utc(iso_text(stamp->time)) == stamp->time, "a time that can be written");
    }
    for (const char c : said_by_openssl(bytes))
        require(static_cast<unsigned char>(c) >= ' ' && c != '\x7f', "a reason fit to be shown");
    const SealCheck seal = seal_from_words(bytes, 1000);
    require(seal.present || !seal.holds(), "a seal that is not there does not hold");
}

}  // namespace runcert::fuzz
