// The reader of tables whose columns the attempt names.

#include "fuzz_target.h"
#include "import_checks.h"

namespace runcert::fuzz {
namespace {

Receiver geodetic() {
    Receiver receiver;
    receiver.id = "primary";
    receiver.recordings = {"recording"};
    receiver.format = "csv";
    receiver.place = "attempt.yaml:5:5";
    receiver.frame = StatedFrame{CoordinateFrame::geodetic};
    receiver.columns = {
        {"time", "time"}, {"latitude", "lat"}, {"longitude", "lon"}, {"height", "h"}};
    return receiver;
}

/// Every column that a geodetic table may have, and a date of its own.
Receiver all_columns() {
    Receiver receiver = geodetic();
    receiver.time_format = "time_of_day";
    receiver.time_scale = "utc";
    for (const char* name : {"date", "sigma_east", "sigma_north", "sigma_up", "velocity_east",
                             "velocity_north", "velocity_up", "fix", "satellites"})
        receiver.columns[name] = name;
    return receiver;
}

Receiver iso() {
    Receiver receiver = geodetic();
    receiver.time_format = "iso";
    receiver.time_scale = "utc";
    receiver.columns.erase("height");
    receiver.height_m = 3.0;
    receiver.accuracy = {.horizontal_m = 2.0, .vertical_m = std::nullopt};
    return receiver;
}

Receiver unix() {
    Receiver receiver = geodetic();
    receiver.time_format = "unix";
    receiver.time_scale = "utc";
    receiver.columns["quality_2d"] = "CQ2D";
    receiver.columns["quality_height"] = "CQ1D";
    return receiver;
}

Receiver ecef() {
    Receiver receiver = geodetic();
    receiver.frame = StatedFrame{CoordinateFrame::ecef};
    receiver.time_format = "seconds_of_week";
    receiver.columns = {{"week", "1"}, {"time", "2"}, {"x", "3"}, {"y", "4"}, {"z", "5"}};
    return receiver;
}

Receiver utm() {
    Receiver receiver = geodetic();
    receiver.frame = StatedFrame{CoordinateFrame::utm};
    receiver.frame->utm_zone = UtmZone{.zone = 55, .northern = false};
    receiver.columns = {{"time", "t"}, {"east", "e"}, {"north", "n"}, {"up", "u"}};
    return receiver;
}

Receiver local_plane() {
    Receiver receiver = geodetic();
    receiver.frame = StatedFrame{CoordinateFrame::local_plane};
    receiver.columns = {{"time", "t"}, {"east", "e"}, {"north", "n"}};
    receiver.start_gps = GpsTime{};
    return receiver;
}

/// What an attempt may say of a table.
Receiver receiver_for(char letter) {
    switch (letter) {
        case 'a':
            return all_columns();
        case 'i':
            return iso();
        case 'x':
            return unix();
        case 'e':
            return ecef();
        case 'u':
            return utm();
        case 'p':
            return local_plane();
        default:
            return geodetic();
    }
}

}  // namespace

/// The first byte is a letter for what the attempt says; what follows it is the table.
void read_input(std::string_view bytes) {
    if (!bytes.empty()) import_and_check(receiver_for(bytes.front()), bytes.substr(1));
}

}  // namespace runcert::fuzz
