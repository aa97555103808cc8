#pragma once

#include <optional>
#include <vector>

#include "stages/check/decision.h"

// Each group's required speed is worked out in its heading, in exact decimals, and each row's
// comment sets (y - T) / u_c against the one-sided quantile of its level (tables of the normal and
// of Student's distribution). The probabilities are scipy 1.10's (stats.norm.cdf,
// stats.t.cdf).
namespace runcert::decision_table {

constexpr double kKmh = 1000.0 / 3600.0;
constexpr double kMps = 1.0;
constexpr double kKnot = 1852.0 / 3600.0;
constexpr double kMph = 1609.344 / 3600.0;
constexpr double kInfinite = 0.0;

/// Speeds in the group's unit.
struct Row {
    double speed;
    double standard_uncertainty;
    double degrees_of_freedom;  ///< or kInfinite
    double level;
    double probability;
    Outcome outcome;
};

struct Task {
    double unit_m_s;
    double record;
    double record_expanded_uncertainty;
    MarginRule rule;
    double speed_to_reach;
    double its_standard_uncertainty;
};

struct Group {
    Task task;
    std::vector<Row> rows;
};

using Rounding = std::optional<DecimalRounding>;

inline MarginRule absolute(double margin_m_s, Rounding rounding = {}) {
    return {.kind = MarginKind::absolute, .value = margin_m_s, .rounding = rounding};
}

inline MarginRule relative(double fraction, Rounding rounding = {}) {
    return {.kind = MarginKind::relative, .value = fraction, .rounding = rounding};
}

inline MarginRule relative_to_upper_limit(double fraction, Rounding rounding = {}) {
    MarginRule rule = relative(fraction, rounding);
    rule.above_upper_limit = true;
    return rule;
}

inline MarginRule over_course(double distance_m, double margin_s, Rounding rounding = {}) {
    return {.kind = MarginKind::elapsed_time,
            .value = margin_s,
            .distance_m = distance_m,
            .rounding = rounding};
}

inline std::vector<Group> groups() {
    using enum Outcome;
    return {
        // NALSA: 126.2 + 1 = 127.2 mph.
        {{kMph, 126.2, 0.0, absolute(1.0 * kMph), 127.2, 0},
         {
             {127.2, 0.0, kInfinite, 0.95, 1.0, beaten},                    // y - T = 0
             {127.199999999, 0.0, kInfinite, 0.95, 0.0, not_beaten},        // y - T = -1e-09
             {127.200000001, 0.0, kInfinite, 0.99, 1.0, beaten},            // y - T = 1e-09
             {127.2, 0.1, kInfinite, 0.95, 0.5, not_proven},                // 0.00000, z 1.64485
             {127.2, 100.0, kInfinite, 0.95, 0.5, not_proven},              // 0.00000, z 1.64485
             {127.36449, 0.1, kInfinite, 0.95, 0.9500047825, beaten},       // 1.64490, z 1.64485
             {127.36448, 0.1, kInfinite, 0.95, 0.9499944689, not_proven},   // 1.64480, z 1.64485
             {127.03552, 0.1, kInfinite, 0.95, 0.05000553109, not_proven},  // -1.64480, z 1.64485
             {127.03551, 0.1, kInfinite, 0.95, 0.04999521747, not_beaten},  // -1.64490, z 1.64485
             {126.2, 0.3, kInfinite, 0.95, 0.0004290603332, not_beaten},    // -3.33333, z 1.64485
             {126.2, 0.7, kInfinite, 0.95, 0.07656372551, not_proven},      // -1.42857, z 1.64485
             {120.0, 0.0, kInfinite, 0.975, 0.0, not_beaten},               // y - T = -7.2
         }},
        // FISLY: 222.43 x 1.002 = 222.87486, cut to 222.87 km/h.
        {{kKmh, 222.43, 0.0, relative(0.002, DecimalRounding{StepRounding::down, kKmh, 2}), 222.87,
          0},
         {
             {222.87, 0.0, kInfinite, 0.95, 1.0, beaten},                     // y - T = 0
             {222.8699999, 0.0, kInfinite, 0.95, 0.0, not_beaten},            // y - T = -1e-07
             {222.873, 0.0, kInfinite, 0.95, 1.0, beaten},                    // y - T = 0.003
             {222.86, 0.0, kInfinite, 0.95, 0.0, not_beaten},                 // y - T = -0.01
             {222.87, 0.02, kInfinite, 0.975, 0.5, not_proven},               // 0.00000, z 1.95996
             {222.9092, 0.02, kInfinite, 0.975, 0.9750021049, beaten},        // 1.96000, z 1.95996
             {222.90919, 0.02, kInfinite, 0.975, 0.9749728701, not_proven},   // 1.95950, z 1.95996
             {222.83081, 0.02, kInfinite, 0.975, 0.02502712994, not_proven},  // -1.95950, z 1.95996
             {222.8308, 0.02, kInfinite, 0.975, 0.02499789515, not_beaten},   // -1.96000, z 1.95996
             {222.92, 0.02, kInfinite, 0.99, 0.9937903347, beaten},           // 2.50000, z 2.32635
             {222.91, 0.02, kInfinite, 0.99, 0.9772498681, not_proven},       // 2.00000, z 2.32635
         }},
        // The same not rounded: what reaches 222.87 does not reach 222.87486.
        {{kKmh, 222.43, 0.0, relative(0.002), 222.87486, 0},
         {
             {222.87, 0.0, kInfinite, 0.95, 0.0, not_beaten},                // y - T = -0.00486
             {222.87486, 0.0, kInfinite, 0.95, 1.0, beaten},                 // y - T = 0
             {222.87485, 0.0, kInfinite, 0.95, 0.0, not_beaten},             // y - T = -1e-05
             {222.8749, 0.0001, kInfinite, 0.95, 0.6554217416, not_proven},  // 0.40000, z 1.64485
             {222.8751, 0.0001, kInfinite, 0.95, 0.9918024641, beaten},      // 2.40000, z 1.64485
             {222.8746, 0.0001, kInfinite, 0.95, 0.004661188024,
              not_beaten},  // -2.60000, z 1.64485
         }},
        // The same rounded up: 222.88.
        {{kKmh, 222.43, 0.0, relative(0.002, DecimalRounding{StepRounding::up, kKmh, 2}), 222.88,
          0},
         {
             {222.875, 0.0, kInfinite, 0.95, 0.0, not_beaten},                // y - T = -0.005
             {222.88, 0.0, kInfinite, 0.95, 1.0, beaten},                     // y - T = 0
             {222.875, 0.001, kInfinite, 0.95, 2.866515719e-07, not_beaten},  // -5.00000, z 1.64485
             {222.882, 0.001, kInfinite, 0.95, 0.9772498681, beaten},         // 2.00000, z 1.64485
             {222.8815, 0.001, kInfinite, 0.95, 0.9331927987, not_proven},    // 1.50000, z 1.64485
         }},
        // 222.60 x 1.002 = 223.0452: cut to 223.04 ...
        {{kKmh, 222.6, 0.0, relative(0.002, DecimalRounding{StepRounding::down, kKmh, 2}), 223.04,
          0},
         {
             {223.04, 0.0, kInfinite, 0.95, 1.0, beaten},              // y - T = 0
             {223.045, 0.0, kInfinite, 0.95, 1.0, beaten},             // y - T = 0.005
             {223.04, 0.001, kInfinite, 0.95, 0.5, not_proven},        // 0.00000, z 1.64485
             {223.045, 0.001, kInfinite, 0.95, 0.9999997133, beaten},  // 5.00000, z 1.64485
         }},
        // ... and to the nearest, 223.05.
        {{kKmh, 222.6, 0.0, relative(0.002, DecimalRounding{StepRounding::nearest, kKmh, 2}),
          223.05, 0},
         {
             {223.04, 0.0, kInfinite, 0.95, 0.0, not_beaten},                // y - T = -0.01
             {223.05, 0.0, kInfinite, 0.95, 1.0, beaten},                    // y - T = 0
             {223.04, 0.001, kInfinite, 0.95, 7.619853024e-24, not_beaten},  // -10.00000, z 1.64485
             {223.045, 0.001, kInfinite, 0.95, 2.866515719e-07, not_beaten},  // -5.00000, z 1.64485
             {223.048, 0.001, kInfinite, 0.95, 0.02275013195, not_beaten},    // -2.00000, z 1.64485
         }},
        // 222.50 x 1.002 = 222.945, a half, taken up: 222.95.
        {{kKmh, 222.5, 0.0, relative(0.002, DecimalRounding{StepRounding::nearest, kKmh, 2}),
          222.95, 0},
         {
             {222.9499999, 0.0, kInfinite, 0.95, 0.0, not_beaten},  // y - T = -1e-07
             {222.95, 0.0, kInfinite, 0.95, 1.0, beaten},           // y - T = 0
         }},
        // 100.00 x 1.002 = 100.20 exactly; binary fractions must not cut it to 100.19 ...
        {{kKmh, 100.0, 0.0, relative(0.002, DecimalRounding{StepRounding::down, kKmh, 2}), 100.2,
          0},
         {
             {100.19, 0.0, kInfinite, 0.95, 0.0, not_beaten},                // y - T = -0.01
             {100.2, 0.0, kInfinite, 0.95, 1.0, beaten},                     // y - T = 0
             {100.195, 0.002, kInfinite, 0.95, 0.006209665326, not_beaten},  // -2.50000, z 1.64485
             {100.19, 0.01, kInfinite, 0.95, 0.1586552539, not_proven},      // -1.00000, z 1.64485
         }},
        // ... nor take it up to 100.21.
        {{kKmh, 100.0, 0.0, relative(0.002, DecimalRounding{StepRounding::up, kKmh, 2}), 100.2, 0},
         {
             {100.2, 0.0, kInfinite, 0.95, 1.0, beaten},               // y - T = 0
             {100.205, 0.002, kInfinite, 0.95, 0.9937903347, beaten},  // 2.50000, z 1.64485
             {100.1999, 0.0, kInfinite, 0.95, 0.0, not_beaten},        // y - T = -0.0001
         }},
        // 60.00 + 0.50 = 60.50 m/s, Student with 3 degrees of freedom.
        {{kMps, 60.0, 0.0, absolute(0.5), 60.5, 0},
         {
             {60.5, 0.0, 3, 0.95, 1.0, beaten},                       // y - T = 0
             {60.4999999, 0.0, 3, 0.95, 0.0, not_beaten},             // y - T = -1e-07
             {60.73534, 0.1, 3, 0.95, 0.9500016591, beaten},          // 2.35340, t(3) 2.35336
             {60.73533, 0.1, 3, 0.95, 0.9499971215, not_proven},      // 2.35330, t(3) 2.35336
             {60.26467, 0.1, 3, 0.95, 0.05000287846, not_proven},     // -2.35330, t(3) 2.35336
             {60.26466, 0.1, 3, 0.95, 0.04999834089, not_beaten},     // -2.35340, t(3) 2.35336
             {60.81825, 0.1, 3, 0.975, 0.9750010306, beaten},         // 3.18250, t(3) 3.18245
             {60.81824, 0.1, 3, 0.975, 0.9749991112, not_proven},     // 3.18240, t(3) 3.18245
             {60.18176, 0.1, 3, 0.975, 0.02500088881, not_proven},    // -3.18240, t(3) 3.18245
             {60.18175, 0.1, 3, 0.975, 0.02499896941, not_beaten},    // -3.18250, t(3) 3.18245
             {60.95408, 0.1, 3, 0.99, 0.9900005761, beaten},          // 4.54080, t(3) 4.54070
             {60.95407, 0.1, 3, 0.99, 0.989999983, not_proven},       // 4.54070, t(3) 4.54070
             {60.04593, 0.1, 3, 0.99, 0.01000001695, not_proven},     // -4.54070, t(3) 4.54070
             {60.04592, 0.1, 3, 0.99, 0.009999423944, not_beaten},    // -4.54080, t(3) 4.54070
             {60.7, 0.1, 3, 0.95, 0.9303370157, not_proven},          // 2.00000, t(3) 2.35336
             {60.7, 0.1, kInfinite, 0.95, 0.9772498681, beaten},      // 2.00000, z 1.64485
             {60.7, 0.1, 3, 0.975, 0.9303370157, not_proven},         // 2.00000, t(3) 3.18245
             {60.7, 0.1, kInfinite, 0.975, 0.9772498681, beaten},     // 2.00000, z 1.95996
             {60.7, 0.1, kInfinite, 0.99, 0.9772498681, not_proven},  // 2.00000, z 2.32635
         }},
        // 50.26 x 1.01 = 50.7626, cut to 50.76 kn.
        {{kKnot, 50.26, 0.0, relative(0.01, DecimalRounding{StepRounding::down, kKnot, 2}), 50.76,
          0},
         {
             {50.76, 0.0, kInfinite, 0.95, 1.0, beaten},                    // y - T = 0
             {50.7599, 0.0, kInfinite, 0.95, 0.0, not_beaten},              // y - T = -0.0001
             {50.8298, 0.03, kInfinite, 0.99, 0.9900084934, beaten},        // 2.32667, z 2.32635
             {50.82979, 0.03, kInfinite, 0.99, 0.9899996125, not_proven},   // 2.32633, z 2.32635
             {50.69021, 0.03, kInfinite, 0.99, 0.01000038755, not_proven},  // -2.32633, z 2.32635
             {50.6902, 0.03, kInfinite, 0.99, 0.009991506644, not_beaten},  // -2.32667, z 2.32635
             {50.7, 1000.0, kInfinite, 0.99, 0.4999760635, not_proven},     // -0.00006, z 2.32635
         }},
        // 25.0 m/s over 500 m are 20 s; 19.99 s are 25.0125063 m/s.
        {{kMps, 25.0, 0.0, over_course(500.0, 0.01), 25.0125062531, 0},
         {
             {25.0125, 0.0, kInfinite, 0.95, 0.0, not_beaten},               // y - T = -6.25313e-06
             {25.01251, 0.0, kInfinite, 0.95, 1.0, beaten},                  // y - T = 3.74687e-06
             {25.0126, 0.0001, kInfinite, 0.95, 0.8257412504, not_proven},   // 0.93747, z 1.64485
             {25.0127, 0.0001, kInfinite, 0.95, 0.9736559642, beaten},       // 1.93747, z 1.64485
             {25.0123, 0.0001, kInfinite, 0.95, 0.01957859202, not_beaten},  // -2.06253, z 1.64485
             {25.0124, 0.0001, kInfinite, 0.95, 0.143997286, not_proven},    // -1.06253, z 1.64485
         }},
        // The same cut to 48.62 kn (48.6204): 25.0122889 m/s.
        {{kMps, 25.0, 0.0, over_course(500.0, 0.01, DecimalRounding{StepRounding::down, kKnot, 2}),
          25.0122888889, 0},
         {
             {25.01228, 0.0, kInfinite, 0.95, 0.0, not_beaten},             // y - T = -8.88889e-06
             {25.01229, 0.0, kInfinite, 0.95, 1.0, beaten},                 // y - T = 1.11111e-06
             {25.0126, 0.0001, kInfinite, 0.95, 0.999068076, beaten},       // 3.11111, z 1.64485
             {25.0124, 0.0001, kInfinite, 0.95, 0.8667397371, not_proven},  // 1.11111, z 1.64485
         }},
        // 40 m/s over 1000 m are 25 s; 20 s are 50 m/s. The record's u = 0.32 counts (50 / 40)^2
        // times.
        {{kMps, 40.0, 0.64, over_course(1000.0, 5.0), 50, 0.5},
         {
             {50.0, 0.0, kInfinite, 0.95, 0.5, not_proven},            // 0.00000, z 1.64485
             {50.7, 0.0, kInfinite, 0.95, 0.9192433408, not_proven},   // 1.40000, z 1.64485
             {50.9, 0.0, kInfinite, 0.95, 0.9640696809, beaten},       // 1.80000, z 1.64485
             {51.1, 0.5, kInfinite, 0.95, 0.9401025348, not_proven},   // 1.55563, z 1.64485
             {51.2, 0.5, kInfinite, 0.95, 0.9551569891, beaten},       // 1.69706, z 1.64485
             {48.8, 0.5, kInfinite, 0.95, 0.04484301089, not_beaten},  // -1.69706, z 1.64485
             {48.9, 0.5, kInfinite, 0.95, 0.05989746521, not_proven},  // -1.55563, z 1.64485
         }},
        // 200 +- 0.6 (k = 2), 1 km/h above: 201, of which u = 0.3; with 0.4 it is 0.5.
        {{kKmh, 200.0, 0.6, absolute(1.0 * kKmh), 201, 0.3},
         {
             {201.0, 0.0, kInfinite, 0.95, 0.5, not_proven},                 // 0.00000, z 1.64485
             {201.4, 0.0, kInfinite, 0.95, 0.9087887803, not_proven},        // 1.33333, z 1.64485
             {201.5, 0.0, kInfinite, 0.95, 0.9522096477, beaten},            // 1.66667, z 1.64485
             {201.82243, 0.4, kInfinite, 0.95, 0.9500006573, beaten},        // 1.64486, z 1.64485
             {201.82242, 0.4, kInfinite, 0.95, 0.9499985946, not_proven},    // 1.64484, z 1.64485
             {200.17758, 0.4, kInfinite, 0.95, 0.05000140544, not_proven},   // -1.64484, z 1.64485
             {200.17757, 0.4, kInfinite, 0.95, 0.04999934272, not_beaten},   // -1.64486, z 1.64485
             {201.97999, 0.4, kInfinite, 0.975, 0.975000936, beaten},        // 1.95998, z 1.95996
             {201.97998, 0.4, kInfinite, 0.975, 0.9749997671, not_proven},   // 1.95996, z 1.95996
             {200.02002, 0.4, kInfinite, 0.975, 0.02500023288, not_proven},  // -1.95996, z 1.95996
             {200.02001, 0.4, kInfinite, 0.975, 0.02499906399, not_beaten},  // -1.95998, z 1.95996
             {201.7, 0.4, kInfinite, 0.95, 0.9192433408, not_proven},        // 1.40000, z 1.64485
         }},
        // The same with 3 degrees of freedom and u = 0.3: u_c = 0.3 sqrt(2), 3 x 4 = 12 degrees.
        {{kKmh, 200.0, 0.6, absolute(1.0 * kKmh), 201, 0.3},
         {
             {201.75, 0.3, 3, 0.95, 0.948753404, not_proven},    // 1.76777, t(12) 1.78229
             {201.76, 0.3, 3, 0.95, 0.9507630571, beaten},       // 1.79134, t(12) 1.78229
             {200.25, 0.3, 3, 0.95, 0.05124659602, not_proven},  // -1.76777, t(12) 1.78229
             {200.24, 0.3, 3, 0.95, 0.04923694293, not_beaten},  // -1.79134, t(12) 1.78229
             {202.13, 0.3, 3, 0.99, 0.9896700704, not_proven},   // 2.66344, t(12) 2.68100
             {202.14, 0.3, 3, 0.99, 0.9901104689, beaten},       // 2.68701, t(12) 2.68100
         }},
        // 200 x 1.02 = 204 km/h, u = 0.306; rounding moves the figure, not the uncertainty.
        {{kKmh, 200.0, 0.6, relative(0.02, DecimalRounding{StepRounding::up, kKmh, 0}), 204, 0.306},
         {
             {204.0, 0.0, kInfinite, 0.95, 0.5, not_proven},             // 0.00000, z 1.64485
             {204.50, 0.0, kInfinite, 0.95, 0.9488692023, not_proven},   // 1.63399, z 1.64485
             {204.51, 0.0, kInfinite, 0.95, 0.9522096477, beaten},       // 1.66667, z 1.64485
             {203.5, 0.0, kInfinite, 0.95, 0.05113079769, not_proven},   // -1.63399, z 1.64485
             {203.49, 0.0, kInfinite, 0.95, 0.04779035227, not_beaten},  // -1.66667, z 1.64485
         }},
        // FAI: (500.00 + 0.40) x 1.02 = 510.408 km/h, cut to 510.40; nothing of the record is left.
        {{kKmh, 500.0, 0.4,
          relative_to_upper_limit(0.02, DecimalRounding{StepRounding::down, kKmh, 2}), 510.4, 0},
         {
             {510.4, 0.0, kInfinite, 0.95, 1.0, beaten},                     // y - T = 0
             {510.39, 0.0, kInfinite, 0.95, 0.0, not_beaten},                // y - T = -0.01
             {510.792, 0.2, kInfinite, 0.975, 0.9750021049, beaten},         // 1.96000, z 1.95996
             {510.79199, 0.2, kInfinite, 0.975, 0.9749991827, not_proven},   // 1.95995, z 1.95996
             {510.00801, 0.2, kInfinite, 0.975, 0.02500081734, not_proven},  // -1.95995, z 1.95996
             {510.008, 0.2, kInfinite, 0.975, 0.02499789515, not_beaten},    // -1.96000, z 1.95996
             {510.8, 0.2, kInfinite, 0.975, 0.9772498681, beaten},           // 2.00000, z 1.95996
         }},
        // No margin: the record is to be reached.
        {{kMph, 126.2, 0.0, absolute(0.0 * kMph), 126.2, 0},
         {
             {126.2, 0.0, kInfinite, 0.95, 1.0, beaten},                 // y - T = 0
             {126.1, 0.0, kInfinite, 0.95, 0.0, not_beaten},             // y - T = -0.1
             {126.2, 0.01, kInfinite, 0.95, 0.5, not_proven},            // 0.00000, z 1.64485
             {126.22, 0.01, kInfinite, 0.95, 0.9772498681, beaten},      // 2.00000, z 1.64485
             {126.21, 0.01, kInfinite, 0.95, 0.8413447461, not_proven},  // 1.00000, z 1.64485
         }},
    };
}

}  // namespace runcert::decision_table
