#include <benchmark/benchmark.h>
#include <fmt/format.h>
#include <malloc.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <cstdlib>
#include <new>

#include "core/angle.h"
#include "core/failure.h"
#include "core/text.h"
#include "stages/import/import.h"
#include "stages/import/novatel/log.h"
#include "store/atomic_file.h"
#include "store/process.h"

// How fast recordings are read (MB/s, 10^6 bytes), how much heap that takes for each epoch at its
// peak, and how much longer gpsbabel takes to read the same file (`gpsbabel_times`), run in turns.
// gpsbabel writes nothing, but its time holds the start of a program (some 20 ms). The bytes of the
// recording itself, which programs map, are no heap.

namespace {

std::atomic<std::size_t> heap_bytes{0};
std::atomic<std::size_t> heap_peak{0};

}  // namespace

// Not inlined: GCC 12 then takes a part of one for not matching the other.
[[gnu::noinline]] void* operator new(std::size_t size) {
    void* memory = std::malloc(size);
    if (!memory) throw std::bad_alloc();
    const std::size_t now = heap_bytes += malloc_usable_size(memory);
    if (now > heap_peak) heap_peak = now;
    return memory;
}
[[gnu::noinline]] void operator delete(void* memory) noexcept {
    heap_bytes -= memory ? malloc_usable_size(memory) : 0;
    std::free(memory);
}
void operator delete(void* memory, std::size_t) noexcept {
    operator delete(memory);
}

namespace runcert::RUNCERT_FILE {
namespace {

double seconds_of(const auto& run) {
    const auto start = std::chrono::steady_clock::now();
    run();
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

/// A craft on a slow curve, 20 Hz from noon: latitude, longitude (deg), height (m), time.
struct Place {
    double latitude_deg, longitude_deg, height_m;
    int hour, minute, second, millisecond;
};

Place place_of(std::int64_t epoch) {
    const double turn = static_cast<double>(epoch) * 1e-4;
    const std::int64_t ms = epoch * 50;
    return {-31.6 + 0.02 * std::sin(turn),      136.0 + 0.02 * std::cos(turn),
            110.0 + std::sin(3.0 * turn),       static_cast<int>(ms / 3'600'000 % 24),
            static_cast<int>(ms / 60'000 % 60), static_cast<int>(ms / 1000 % 60),
            static_cast<int>(ms % 1000)};
}

std::string pos_text(std::int64_t epochs) {
    std::string text =
        "%  GPST                   latitude(deg) longitude(deg)  height(m)   Q  ns   sdn(m)   "
        "sde(m)   sdu(m)  sdne(m)  sdeu(m)  sdun(m) age(s)  ratio\n";
    for (std::int64_t i = 0; i < epochs; ++i) {
        const Place at = place_of(i);
        text += fmt::format(
            "{:04} {:10.3f} {:14.9f} {:14.9f} {:10.4f}   1  14   0.0040   0.0030   0.0100  "
            "0.0010  -0.0010   0.0020   0.50   25.1\n",
            2300 + i / 12'096'000, static_cast<double>(i % 12'096'000) * 0.05, at.latitude_deg,
            at.longitude_deg, at.height_m);
    }
    return text;
}

void add_sentence(std::string& text, const std::string& body) {
    unsigned sum = 0;
    for (const char c : body)
        sum ^= static_cast<unsigned char>(c);
    text += fmt::format("${}*{:02X}\r\n", body, sum);
}

std::string nmea_text(std::int64_t epochs) {
    std::string text;
    for (std::int64_t i = 0; i < epochs; ++i) {
        const Place at = place_of(i % 1'728'000);  // a day
        const double south = -at.latitude_deg;
        const std::string time = fmt::format("{:02}{:02}{:02}.{:02}", at.hour, at.minute, at.second,
                                             at.millisecond / 10);
        const std::string place =
            fmt::format("{:02.0f}{:010.7f},S,{:03.0f}{:010.7f},E", std::floor(south),
                        60.0 * (south - std::floor(south)), std::floor(at.longitude_deg),
                        60.0 * (at.longitude_deg - std::floor(at.longitude_deg)));
        add_sentence(text, fmt::format("GNGGA,{},{},4,14,0.7,{:.3f},M,2.100,M,0.5,0001", time,
                                       place, at.height_m));
        add_sentence(text, fmt::format("GNRMC,{},A,{},48.512,271.33,140326,,,R", time, place));
        add_sentence(text, "GNVTG,271.33,T,,M,48.512,N,89.844,K,D");
        add_sentence(text, fmt::format("GNGST,{},4.2,0.012,0.009,33.1,0.010,0.011,0.021", time));
    }
    return text;
}

/// "2026-03-14T03:20:18.050Z", the day and what follows counted on.
std::string utc_text(std::int64_t epoch) {
    const Place at = place_of(epoch);
    return fmt::format("2026-03-{:02}T{:02}:{:02}:{:02}.{:03}Z", 1 + epoch / 1'728'000 % 28,
                       at.hour, at.minute, at.second, at.millisecond);
}

std::string gpx_text(std::int64_t epochs) {
    std::string text =
        "<?xml version=\"1.0\"?>\n<gpx version=\"1.1\" creator=\"benchmark\" "
        "xmlns=\"http://www.topografix.com/GPX/1/1\"><trk><trkseg>\n";
    for (std::int64_t i = 0; i < epochs; ++i) {
        const Place at = place_of(i);
        text += fmt::format(
            "<trkpt lat=\"{:.8f}\" lon=\"{:.8f}\"><ele>{:.2f}</ele><time>{}</time></trkpt>\n",
            at.latitude_deg, at.longitude_deg, at.height_m, utc_text(i));
    }
    return text + "</trkseg></trk></gpx>\n";
}

std::string csv_text(std::int64_t epochs) {
    std::string text = "time,lat,lon,height,sigma\n";
    for (std::int64_t i = 0; i < epochs; ++i) {
        const Place at = place_of(i);
        text += fmt::format("{},{:.9f},{:.9f},{:.4f},0.0120\n", utc_text(i), at.latitude_deg,
                            at.longitude_deg, at.height_m);
    }
    return text;
}

std::string flysight_text(std::int64_t epochs) {
    std::string text =
        "time,lat,lon,hMSL,velN,velE,velD,hAcc,vAcc,sAcc,heading,cAcc,gpsFix,numSV\n"
        ",(deg),(deg),(m),(m/s),(m/s),(m/s),(m),(m),(m/s),(deg),(deg),,\n";
    for (std::int64_t i = 0; i < epochs; ++i) {
        const Place at = place_of(i);
        text += fmt::format(
            "{},{:.7f},{:.7f},{:.3f},24.95,-3.10,0.12,0.512,0.830,0.21,352.91712,0.50115,3,14\n",
            utc_text(i), at.latitude_deg, at.longitude_deg, at.height_m);
    }
    return text;
}

std::string vbo_text(std::int64_t epochs) {
    std::string text =
        "File created on 14/03/2026 @ "
        "00:00:00\r\n\r\n[header]\r\nsatellites\r\ntime\r\nlatitude\r\n"
        "longitude\r\nvelocity kmh\r\nheading\r\nheight\r\n\r\n[column names]\r\nsats time lat "
        "long "
        "velocity heading height\r\n\r\n[data]\r\n";
    for (std::int64_t i = 0; i < epochs; ++i) {
        const Place at = place_of(i % 1'728'000);  // a day
        text += fmt::format(
            "014 {:02}{:02}{:02}.{:03} {:+012.6f} {:+013.6f} 089.844 271.33 {:+09.3f}\r\n", at.hour,
            at.minute, at.second, at.millisecond, 60.0 * at.latitude_deg, -60.0 * at.longitude_deg,
            at.height_m);
    }
    return text;
}

std::string igc_text(std::int64_t epochs) {
    std::string text =
        "AXLX123 "
        "FLIGHT:1\r\nHFDTEDATE:140326,01\r\nHFALGALTGPS:ELL\r\nHFDTM100GPSDATUM:WGS-1984\r\n";
    for (std::int64_t i = 0; i < epochs; ++i) {
        const Place at = place_of(i * 20 % 1'728'000);  // every second of a day
        const double south = -at.latitude_deg;
        const auto minutes = [](double degrees) {
            return std::min(59'999, static_cast<int>(60'000.0 * (degrees - std::floor(degrees))));
        };
        text += fmt::format("B{:02}{:02}{:02}{:02.0f}{:05}S{:03.0f}{:05}EA{:05.0f}{:05.0f}\r\n",
                            at.hour, at.minute, at.second, std::floor(south), minutes(south),
                            std::floor(at.longitude_deg), minutes(at.longitude_deg), at.height_m,
                            at.height_m);
    }
    return text;
}

/// The columns of csv_text between blanks, as programs of fixed width write them.
std::string blanks_text(std::int64_t epochs) {
    std::string text = "              time         lat          lon    height   sigma\n";
    for (std::int64_t i = 0; i < epochs; ++i) {
        const Place at = place_of(i);
        text += fmt::format("{} {:12.9f} {:13.9f} {:9.4f}  0.0120\n", utc_text(i), at.latitude_deg,
                            at.longitude_deg, at.height_m);
    }
    return text;
}

std::string racechrono_text(std::int64_t epochs) {
    std::string text =
        "This file is created using RaceChrono Pro v9.1.3 ( http://racechrono.com/ ).\nFormat,3\n"
        "Note,\n\n"
        "timestamp,lap_number,accuracy,altitude,bearing,latitude,longitude,satellites,speed\n"
        "unix time,,m,m,deg,deg,deg,sats,m/s\n,,100: gps,100: gps,100: gps,100: gps,100: gps,"
        "100: gps,100: gps\n";
    for (std::int64_t i = 0; i < epochs; ++i) {
        const Place at = place_of(i);
        text += fmt::format("{:.3f},1,0.52,{:.3f},271.33,{:.7f},{:.7f},14,24.95\n",
                            1'773'446'400.0 + 0.05 * static_cast<double>(i), at.height_m,
                            at.latitude_deg, at.longitude_deg);
    }
    return text;
}

std::string racebox_text(std::int64_t epochs) {
    std::string text =
        "Format,RaceBox CSV\nTrack,Test\n\nRecord,Time,Latitude,Longitude,Altitude (m),Speed "
        "(m/s),GForceX (g),Lap,Heading\n";
    for (std::int64_t i = 0; i < epochs; ++i) {
        const Place at = place_of(i);
        text += fmt::format("{},{},{:.7f},{:.7f},{:.2f},24.95,0.12,1,271.33\n", i, utc_text(i),
                            at.latitude_deg, at.longitude_deg, at.height_m);
    }
    return text;
}

std::string trackaddict_text(std::int64_t epochs) {
    std::string text =
        "# RaceRender Data: TrackAddict 4.3.5 on Android 9\n\"Time\",\"UTC Time\",\"GPS_Update\","
        "\"Latitude\",\"Longitude\",\"Altitude (ft)\",\"Speed (Km/h)\",\"Heading\",\"Accuracy "
        "(m)\"\n";
    for (std::int64_t i = 0; i < epochs; ++i) {
        const Place at = place_of(i);
        text += fmt::format("{:.3f},{:.3f},1,{:.7f},{:.7f},{:.1f},89.84,271.3,0.5\n",
                            0.05 * static_cast<double>(i),
                            1'773'446'400.0 + 0.05 * static_cast<double>(i), at.latitude_deg,
                            at.longitude_deg, at.height_m / 0.3048);
    }
    return text;
}

std::string aim_text(std::int64_t epochs) {
    std::string text =
        "\"Format\",\"AiM CSV File\"\n\"Session\",\"Test\"\n\n\"Time\",\"GPS Speed\",\"GPS "
        "Nsat\",\"GPS Altitude\",\"GPS Latitude\",\"GPS "
        "Longitude\"\n\"s\",\"km/h\",\"#\",\"m\",\"deg\",\"deg\"\n\n";
    for (std::int64_t i = 0; i < epochs; ++i) {
        const Place at = place_of(i);
        text += fmt::format("\"{:.3f}\",\"{:.3f}\",\"14\",\"{:.2f}\",\"{:.8f}\",\"{:.8f}\"\n",
                            0.05 * static_cast<double>(i),
                            89.0 + std::sin(0.1 * static_cast<double>(i)), at.height_m,
                            at.latitude_deg, at.longitude_deg);
    }
    return text;
}

std::string novatel_text(std::int64_t epochs) {
    std::string text;
    const auto add = [&](const char* name, std::int64_t i, const std::string& fields) {
        const std::string body =
            fmt::format("{},COM1,0,85.0,FINESTEERING,{},{:.3f},02000020,cdba,32768;{}", name,
                        2300 + i / 12'096'000, static_cast<double>(i % 12'096'000) * 0.05, fields);
        text += fmt::format("#{}*{:08x}\r\n", body, novatel::crc32(body));
    };
    for (std::int64_t i = 0; i < epochs; ++i) {
        const Place at = place_of(i);
        add("BESTPOSA", i,
            fmt::format("SOL_COMPUTED,NARROW_INT,{:.11f},{:.11f},{:.4f},47.2500,WGS84,0.0200,"
                        "0.0100,0.0300,\"AAAA\",1.500,0.000,20,18,18,0,00,00,00,11",
                        at.latitude_deg, at.longitude_deg, at.height_m));
        add("BESTVELA", i,
            "SOL_COMPUTED,DOPPLER_VELOCITY,0.150,0.000,24.9500,271.330000,0.1200,0.0");
    }
    return text;
}

std::string septentrio_text(std::int64_t epochs) {
    std::string text;
    for (std::int64_t i = 0; i < epochs; ++i) {
        const Place at = place_of(i);
        text += fmt::format(
            "-1 {:13.2f} {:14.11f} {:15.11f} {:14.5f} {:14.5f} {:10.5f} {:10.5f} {:10.5f} "
            "{:15.8e} {:13.6e} {:3} {:3} {:3} {:3} {:10.3f}\n",
            1.4e9 + 0.05 * static_cast<double>(i), Angle::from_degrees(at.latitude_deg).radians(),
            Angle::from_degrees(at.longitude_deg).radians(), at.height_m, 2.1, 3.1, -24.9, 0.12,
            1e-5, 1e-7, 14, 4, 150, 0, 271.33);
    }
    return text;
}

Receiver receiver() {
    Receiver any;
    any.id = "primary";
    any.format = "auto";
    return any;
}

/// One reading of a text into its rows.
using Read = std::size_t (*)(const std::string& text);

std::size_t read_recording(const std::string& text) {
    return import_recording(receiver(), {.name = "recording", .bytes = text}).rows.size();
}

std::size_t read_described(const std::string& text) {
    Receiver described = receiver();
    described.format = "csv";
    described.frame = StatedFrame{CoordinateFrame::geodetic};
    described.time_format = "iso";
    described.time_scale = "utc";
    described.columns = {{"time", "time"},     {"latitude", "lat"},     {"longitude", "lon"},
                         {"height", "height"}, {"sigma_east", "sigma"}, {"sigma_north", "sigma"},
                         {"sigma_up", "sigma"}};
    return import_recording(described, {.name = "recording", .bytes = text}).rows.size();
}

std::size_t read_table(const std::string& text) {
    return read_observations(text, "table").rows.size();
}

void reading(benchmark::State& state, const std::string& text, Read read,
             const char* gpsbabel_format) {
    const TemporaryFolder folder;
    const std::string file = folder.path() / "recording";
    if (gpsbabel_format) write_file_atomically(file, text);
    double ours_s = 0.0, gpsbabel_s = 0.0;
    std::size_t epochs = 0;
    for (auto _ : state) {
        const std::size_t before = heap_bytes;
        heap_peak = before;
        ours_s += seconds_of([&] { epochs = read(text); });
        state.counters["heap_bytes_per_epoch"] =
            static_cast<double>(heap_peak - before) / static_cast<double>(epochs);
        if (gpsbabel_format)
            gpsbabel_s += seconds_of([&] {
                const auto result =
                    run_process({"gpsbabel", "-t", "-i", gpsbabel_format, "-f", file});
                if (result.exit_status != 0) state.SkipWithError("gpsbabel could not read it");
            });
    }
    state.counters["epochs"] = static_cast<double>(epochs);
    state.counters["MB_per_s"] =
        1e-6 * static_cast<double>(text.size()) * static_cast<double>(state.iterations()) / ours_s;
    if (gpsbabel_format) state.counters["gpsbabel_times"] = gpsbabel_s / ours_s;
}

/// A recording that says itself what it is, and that gpsbabel does not read.
template <std::string (*text)(std::int64_t epochs)>
void recording(benchmark::State& state) {
    reading(state, text(state.range(0)), read_recording, nullptr);
}
void pos(benchmark::State& state) {
    reading(state, pos_text(state.range(0)), read_recording, nullptr);
}
void nmea(benchmark::State& state) {
    // gpsbabel holds all points, and would take minutes and gigabytes for ten million.
    const bool beside = state.range(0) <= 1'000'000;
    reading(state, nmea_text(state.range(0)), read_recording, beside ? "nmea" : nullptr);
}
void gpx(benchmark::State& state) {
    reading(state, gpx_text(state.range(0)), read_recording, "gpx");
}
void csv(benchmark::State& state) {
    reading(state, csv_text(state.range(0)), read_described, nullptr);
}
void blanks(benchmark::State& state) {
    reading(state, blanks_text(state.range(0)), read_described, nullptr);
}
void igc(benchmark::State& state) {
    reading(state, igc_text(state.range(0)), read_recording, "igc");
}
void ecsv(benchmark::State& state) {
    const std::string text = pos_text(state.range(0));
    reading(state, write_observations(import_recording(receiver(), {.name = "f", .bytes = text})),
            read_table, nullptr);
}

/// A logger's real recording, as often as it takes to be long.
void oao(benchmark::State& state) {
    const char* data = std::getenv("RUNCERT_DATA");
    if (!data) return state.SkipWithError("RUNCERT_DATA is not set");
    const std::string once = read_file(std::string(data) + "/windsurf_loggers/head_left.oao");
    std::string text;
    for (std::int64_t i = 0; i < state.range(0); ++i)
        text += once;
    reading(state, text, read_recording, nullptr);
}

BENCHMARK(pos)->Arg(200'000)->Unit(benchmark::kMillisecond);
BENCHMARK(pos)->Arg(10'000'000)->Iterations(1)->Unit(benchmark::kMillisecond);
BENCHMARK(nmea)->Arg(200'000)->Unit(benchmark::kMillisecond);
BENCHMARK(nmea)->Arg(10'000'000)->Iterations(1)->Unit(benchmark::kMillisecond);
BENCHMARK(gpx)->Arg(200'000)->Unit(benchmark::kMillisecond);
BENCHMARK(csv)->Arg(200'000)->Unit(benchmark::kMillisecond);
BENCHMARK(blanks)->Arg(200'000)->Unit(benchmark::kMillisecond);
BENCHMARK(recording<racechrono_text>)
    ->Name("racechrono")
    ->Arg(200'000)
    ->Unit(benchmark::kMillisecond);
BENCHMARK(recording<racebox_text>)->Name("racebox")->Arg(200'000)->Unit(benchmark::kMillisecond);
BENCHMARK(recording<trackaddict_text>)
    ->Name("trackaddict")
    ->Arg(200'000)
    ->Unit(benchmark::kMillisecond);
BENCHMARK(recording<aim_text>)->Name("aim")->Arg(200'000)->Unit(benchmark::kMillisecond);
BENCHMARK(recording<novatel_text>)->Name("novatel")->Arg(200'000)->Unit(benchmark::kMillisecond);
BENCHMARK(recording<septentrio_text>)
    ->Name("septentrio")
    ->Arg(200'000)
    ->Unit(benchmark::kMillisecond);
BENCHMARK(recording<flysight_text>)->Name("flysight")->Arg(200'000)->Unit(benchmark::kMillisecond);
BENCHMARK(recording<vbo_text>)->Name("vbo")->Arg(200'000)->Unit(benchmark::kMillisecond);
BENCHMARK(igc)->Arg(80'000)->Unit(benchmark::kMillisecond);
BENCHMARK(oao)->Arg(10)->Unit(benchmark::kMillisecond);
BENCHMARK(ecsv)->Arg(200'000)->Unit(benchmark::kMillisecond);
BENCHMARK(ecsv)->Arg(10'000'000)->Iterations(1)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace runcert::RUNCERT_FILE
