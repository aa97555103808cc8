#pragma once

#include <algorithm>
#include <string>
#include <string_view>

#include "import_test_support.h"

namespace runcert::vbo_test {

using namespace import_test;

inline const std::string header =
    "File created on 31/07/2006 at 17:55:20\r\n\r\n"
    "[header]\r\nsatellites\r\ntime\r\nlatitude\r\nlongitude\r\nvelocity kmh\r\nheading\r\n"
    "height\r\nvertical velocity m/s\r\n\r\n"
    "[channel units]\r\n\r\n"
    "[comments]\r\n(c) 2001 2003 Racelogic\r\nVBox II Version 4.5a\r\nGPS : SSX2g\r\n"
    "Serial Number : 005201\r\nSt\xe4"
    "be \xfc\r\n\r\n"
    "[column names]\r\nsats time lat long velocity heading height vert-vel\r\n\r\n"
    "[data]\r\n";
inline const std::string row =
    "137 162235.40 +03119.09973 +00058.49277 072.000 150.00 +00152.58 -001.250\r\n";
inline const std::string next_row =
    "137 162235.50 +03119.08873 +00058.48277 072.000 150.00 +00152.58 -001.250\r\n";

inline Observations import_vbo(const std::string& text, const Receiver& receiver = pos_receiver()) {
    return import_text(receiver, text);
}

}  // namespace runcert::vbo_test
