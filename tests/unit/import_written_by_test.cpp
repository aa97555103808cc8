#include <gtest/gtest.h>

#include "import_test_support.h"
#include "stages/import/import.h"

// What a recording says of the programs that made it: marks of simulators above all, in whatever
// format, case, language and encoding.

namespace runcert::RUNCERT_FILE {
namespace {

Observations seen(const std::string& bytes, const std::string& name = "folder/f",
                  bool named = false) {
    Observations observations;
    note_written_by({.name = name, .bytes = bytes}, named, observations);
    return observations;
}

std::string utf16_of(const std::string& ascii) {
    std::string bytes = "\xff\xfe";
    for (const char c : ascii)
        bytes += std::string{c, '\0'};
    return bytes;
}

TEST(WrittenBy, AMarkOfASimulatorIsReadInEveryFormat) {
    for (const std::string& text : std::vector<std::string>{
             "% program   : runcert simulate (no receiver: this recording is simulated)\n",
             "# runcert simulate (no receiver: this recording is simulated)\n1,2\n",
             "# simulated run, seed: 0\n",
             "# simulated: 0.5 m of noise\n",
             "Simulated,no wind\n",
             "time,lat,lon # Simulated\n",
             "$GPTXT,01,01,02,NMEA Simulator 2.1*00\r\n",
             "<gpx creator=\"GPS Simulator\">",
             "<gpx><!-- SIMULATED TRACK --><trk>",
             "<kml><description>simulation run 4</description>",
             "[comments]\r\nVBOX simulator\r\n",
             "LXXXSIMULATED FLIGHT\r\n",
             "LCONFPLBEGIN\r\n",
             "HOPLTPILOT:SimulatedPilot\r\n",
             "runcert simulate    simulated                               PGM / RUN BY / DATE\n",
             "$FLYS,1\n$VAR,FIRMWARE_VER,emulator\n",
             "Format,RaceBox\nDevice,x-plane 12\n",
             "created with nmeagen.org\n",
             "mock location provider\n",
             "isFromMockLocation,true\n",
             "source: gps-sdr-sim\n"}) {
        EXPECT_TRUE(seen(text).simulated) << text;
        EXPECT_EQ(seen(text).written_by.size(), 1U) << text;
    }
}

TEST(WrittenBy, AMarkIsReadInOtherLanguagesAndEncodings) {
    for (const std::string& text : std::vector<std::string>{
             "# Simulierte Fahrt\n", "# simulé\n", "# enregistrement SIMUL\xc9 (latin-1)\n",
             "# datos simulados\n", "# simulazione\n", "# gesimuleerd\n", "# symulacja, simulace\n",
             "# Симуляция заезда\n", "# СИМУЛЯТОР\n", "# имитация\n",
             "# \xf1\xe8\xec\xf3\xeb\xff\xf2\xee\xf0\n", "# προσομοίωση\n", "# シミュレーション\n",
             "# 模拟数据\n", "# 仿真\n", "# 시뮬레이션\n", "# محاكاة\n",
             utf16_of("# this run is Simulated\n")})
        EXPECT_TRUE(seen(text).simulated) << text;
}

TEST(WrittenBy, WhatOnlySoundsLikeItIsNoMark) {
    for (const std::string& text : std::vector<std::string>{
             "# simultaneous logging of two receivers\n", "# not simulated\n", "# no simulation\n",
             "Simulation mode: off\n", "simulated=false\n", "Simulator: 0\n", "# SIMULTAN\n",
             "# Firmware 1.02, serial 77\n", "time_s,east_m,north_m,up_m\n0.0,1.0,2.0,3.0\n",
             "$GPGGA,120000.00,3130.0,S,13600.0,E,4,12,0.8,100.0,M,,M,,*00\r\n"}) {
        EXPECT_FALSE(seen(text).simulated) << text;
        EXPECT_TRUE(seen(text).written_by.empty()) << text;
    }
}

TEST(WrittenBy, ConvertersAndEditorsAreNamedAsTheFileNamesThem) {
    struct Case {
        std::string text, said;
    };
    for (const Case& one : std::vector<Case>{
             {"<gpx version=\"1.0\" creator=\"GPSBabel - https://www.gpsbabel.org\">",
              "<gpx version=\"1.0\" creator=\"GPSBabel - https://www.gpsbabel.org\">"},
             {"# edited with GpsPrune 21\nx\n", "# edited with GpsPrune 21"},
             {"<kml><Document><name>Google Earth</name>",
              "<kml><Document><name>Google Earth</name>"},
             {"x\r\ncreator: Garmin BaseCamp 4.7\r\ny", "creator: Garmin BaseCamp 4.7"},
             {"CONVBIN 2.4.3       me                  20260314            PGM / RUN BY / DATE\n",
              "CONVBIN 2.4.3       me                  20260314            PGM / RUN BY / DATE"},
             {"# erstellt mit Excel\n", "# erstellt mit Excel"},
             {"; Exported from RaceStudio 3\n", "; Exported from RaceStudio 3"},
             {"# Resampled to 25 Hz\n", "# Resampled to 25 Hz"}}) {
        const Observations found = seen(one.text);
        EXPECT_EQ(found.written_by, std::vector<std::string>{one.said});
        EXPECT_FALSE(found.simulated) << one.text;
    }
}

TEST(WrittenBy, AMarkIsFoundWhereverItStandsAndInBinaryFiles) {
    std::string rows;
    for (int k = 0; k < 20000; ++k)
        rows += "2026/03/14 03:20:18.000  -31.600000026  135.999999922   109.9865   1  20\n";
    EXPECT_TRUE(seen(rows + "# simulated\n" + rows).simulated);
    EXPECT_TRUE(seen(rows + "# simulated").simulated);
    std::string binary;
    for (int k = 0; k < 4096; ++k)
        binary += static_cast<char>((k * 131 + k / 256 * 17) % 256);
    EXPECT_TRUE(seen(binary).written_by.empty());
    const Observations found = seen(binary + std::string("\xb5\x62\x04\x04\x0f\0", 6) +
                                    "GNSS SIMULATOR 7" + std::string("\0\1", 2) + binary);
    EXPECT_TRUE(found.simulated);
    ASSERT_EQ(found.written_by.size(), 1U);
    EXPECT_NE(found.written_by[0].find("GNSS SIMULATOR 7"), std::string::npos);
}

TEST(WrittenBy, ManyLinesAreCutAndWhatSaysSimulatedIsNeverLeftOut) {
    std::string text;
    for (int k = 0; k < 40; ++k)
        text += "# converted by step " + std::to_string(k) + "\n";
    const Observations found = seen(text + "# simulated\n");
    EXPECT_EQ(found.written_by.size(), 8U);
    EXPECT_EQ(found.written_by.back(), "# simulated");
    const std::string long_line = "# converted by " + std::string(100000, 'x') + "\n";
    EXPECT_LT(seen(long_line).written_by.at(0).size(), 200U);
    EXPECT_EQ(seen("# generated \x01\x02\xff by me\n").written_by.at(0), "# generated");
}

TEST(WrittenBy, SeveralFilesAreNamedWithoutTheirFolders) {
    EXPECT_EQ(seen("# simulated\n", "/home/someone/raw.obs", true).written_by,
              std::vector<std::string>{"raw.obs: # simulated"});
    Observations known;
    known.device = "GPSBabel 1.8";
    note_written_by({.name = "f", .bytes = "creator=\"GPSBabel 1.8\"\n"}, false, known);
    EXPECT_TRUE(known.written_by.empty());  // said already
}

TEST(WrittenBy, NmeaSaysByQualityAndModeThatItIsOfASimulator) {
    const auto sentence = [](const std::string& body) {
        unsigned sum = 0;
        for (const char c : body)
            sum ^= static_cast<unsigned char>(c);
        return fmt::format("${}*{:02X}\r\n", body, sum);
    };
    const auto read = [&](char quality, char mode) {
        std::string text;
        for (int second = 0; second < 5; ++second) {
            text +=
                sentence(fmt::format("GPGGA,1200{:02}.00,3130.0000,S,13600.0{:03},E,{},12,0.8,"
                                     "100.0,M,0.0,M,,",
                                     second, second, quality));
            text +=
                sentence(fmt::format("GPRMC,1200{:02}.00,A,3130.0000,S,13600.0{:03},E,10.0,90.0,"
                                     "140326,,,{}",
                                     second, second, mode));
        }
        return import_test::import_text(import_test::pos_receiver(), text);
    };
    EXPECT_FALSE(read('4', 'R').simulated);
    EXPECT_TRUE(read('4', 'R').written_by.empty());
    for (const auto& [quality, mode] : {std::pair('8', 'S'), {'8', 'R'}, {'4', 'S'}}) {
        const Observations found = read(quality, mode);
        EXPECT_TRUE(found.simulated) << quality << mode;
        ASSERT_EQ(found.written_by.size(), 1U);
        EXPECT_NE(found.written_by[0].find("quality 8 or mode S, those of a simulator"),
                  std::string::npos);
    }
}

TEST(Processing, OfAnRtklibHeaderIsReadWithoutFolders) {
    const Observations read = import_test::import_text(
        import_test::pos_receiver(),
        "% program   : RTKPOST ver.2.4.3 b34\n"
        "% inp file  : C:\\Users\\me\\2022\\rover.obs\n"
        "% inp file  : /home/me/base.22o\n"
        "% inp file  : brdc.nav\n"
        "% obs start : 2022/03/18 08:51:22.3 GPST (week2201 463900.3s)\n"
        "% obs end   : 2022/03/18 08:52:02.0 GPST (week2201 463922.0s)\n"
        "% pos mode  : kinematic\n"
        "% solution  : combined\n"
        "% ref pos   : 35.134709483 136.977574275  104.7280\n"
        "%\n"
        "% (lat/lon/height=WGS84/ellipsoidal,Q=1:fix,2:float,ns=# of satellites)\n"
        "%  GPST latitude(deg) longitude(deg) height(m) Q ns sdn(m) sde(m) sdu(m) sdne(m) sdeu(m) "
        "sdun(m) age(s) ratio\n"
        "2022/03/18 08:51:22.300 35.1 137.0 10.0 1 10 0.01 0.01 0.02 0 0 0 0 9\n"
        "2022/03/18 08:51:22.400 35.1 137.0 10.0 1 10 0.01 0.01 0.02 0 0 0 0 9\n");
    ASSERT_TRUE(read.processing.has_value());
    const Processing& processing = *read.processing;
    EXPECT_EQ(processing.program, "RTKPOST ver.2.4.3 b34");
    EXPECT_EQ(processing.files, (std::vector<std::string>{"rover.obs", "base.22o", "brdc.nav"}));
    EXPECT_EQ(processing.begin, "2022/03/18 08:51:22.3 GPST (week2201 463900.3s)");
    EXPECT_EQ(processing.end, "2022/03/18 08:52:02.0 GPST (week2201 463922.0s)");
    EXPECT_EQ(processing.options,
              (std::vector<std::string>{"pos mode: kinematic", "solution: combined",
                                        "ref pos: 35.134709483 136.977574275  104.7280"}));
}

TEST(Processing, OfAHeaderWithoutAnyIsAbsentAndAHugeOneIsCut) {
    const std::string rows =
        "%  GPST latitude(deg) longitude(deg) height(m) Q ns sdn(m) sde(m) sdu(m) sdne(m) sdeu(m) "
        "sdun(m) age(s) ratio\n"
        "2022/03/18 08:51:22.300 35.1 137.0 10.0 1 10 0.01 0.01 0.02 0 0 0 0 9\n";
    EXPECT_FALSE(import_test::import_text(import_test::pos_receiver(), rows).processing);
    std::string header;
    for (int k = 0; k < 60; ++k)
        header += fmt::format("% inp file  : {}{}\n% opt {}: {}\n", std::string(300, 'a'), k, k,
                              std::string(300, 'b'));
    const auto cut =
        import_test::import_text(import_test::pos_receiver(), header + rows).processing;
    ASSERT_TRUE(cut.has_value());
    EXPECT_EQ(cut->files.size(), 40U);
    EXPECT_EQ(cut->options.size(), 40U);
    EXPECT_LT(cut->options[0].size(), 160U);
}

}  // namespace
}  // namespace runcert::RUNCERT_FILE
