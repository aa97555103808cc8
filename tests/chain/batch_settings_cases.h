#pragma once

// An attempt in which every key has an effect, and another value for those keys that need more than
// another one of their kind.

namespace runcert::chain {

/// A sailing boat over a course, seen by two receivers.
inline constexpr const char* course_case = R"yaml(
attempt:
  schema: attempt/1.0
  id: base
  craft: {name: sloop, class: sail-boat, registration: GER 17, sail_area_m2: 9.5}
  pilot: A. Sailor
  organisation: a club
  contact: at the club
  place: canal
  utc_offset: "+02:00"
  date: "2026-10-20"
  officials: [{role: measurer, name: A. Person}, {role: timekeeper}]
  signatures: [{role: measurer, count: 1}]
  amends: {report_id: 0123456789abcdef, sha256: 0123456789abcdef0123456789abcdef0123456789abcdef0123456789abcdef, reason: a slip}
  decision_rule_agreed: {date: "2026-10-01", by: the board and the team}
  receivers:
    - id: primary
      recording: a.pos
      antenna_height_m: 1.5
      lever_arm_m: {forward: 0.5, right: 0.1, down: -1.2}
      rotation_bound_deg: 4
      galileo_keys: [{number: 3, pem: a key}]
      device_deduction: {speed: 0.1, unit: kn}
      instrument: {make: a maker, model: a logger, serial: "17", firmware: "1.2", antenna: a patch}
      calibration: {certificate: a number, laboratory: a laboratory, date: "2026-09-01", expanded_uncertainty: 0.05, unit: km/h, of: speed}
    - {id: second, recording: b.pos, antenna_motion: {height_m: 2, roll_deg: 5, pitch_deg: 2, roll_period_s: 3, leeway_deg: 4}}
  origin: {latitude_deg: -22.92, longitude_deg: 14.41, height_m: 30.0}
  record: {speed: 50, unit: kn, source: a list}
  rules:
    - {profile: time, figure: margin.value, value: 0.9, reason: agreed}
    - {profile: time, figure: window.duration_s, value: 2.5}
  profiles: [time.yaml, course.yaml]
  course:
    length_m: 500
    length_expanded_uncertainty_m: 0.02
    start:
      left: {latitude_deg: -22.919728996, longitude_deg: 14.415848892}
      right: {latitude_deg: -22.920270789, longitude_deg: 14.415848915}
    finish:
      left: {latitude_deg: -22.919728742, longitude_deg: 14.420722968}
      right: {latitude_deg: -22.920270534, longitude_deg: 14.420723010}
  ground_height_m: 30
  part: {from_utc: "2026-10-20T10:59:00.000", to_utc: "2026-10-20T11:30:00.000", source: a log}
  wind: {file: wind.csv, source: anemometer}
  current: {file: current.csv, source: float, expanded_uncertainty_m_s: 0.01}
  wheel: {file: wheel.csv, source: rear wheel, scale: 1.01, expanded_uncertainty_scale: 0.002}
  gates: {file: gates.csv, source: light gates, expanded_uncertainty_m: 0.02, expanded_uncertainty_s: 0.002}
  speed_trap: {file: trap.csv, source: a gun}
  secondary: {method: video, source: a sheet, start_utc: "2026-10-20T11:00:41.435", finish_utc: "2026-10-20T11:00:59.297", time_expanded_uncertainty_s: 0.010}
  parameters: {window: {selection_samples: 100, monte_carlo_trials_max: 100000}}
rules:
  time:
    schema: profile/1.0
    id: time
    revision: 1
    body: a body
    title: a title
    looked_at: "2026-01-01"
    valid_from: "2026-01-01"
    window: {kind: time, duration_s: 3, definition: displacement, dimension: horizontal, source: position, ends: epochs, exact: false, count: 1}
    runs: {start_m_s: 2, stop_m_s: 1, stop_s: 5, turn_deg: 90}
    accuracy: {limit: 0.8, unit: km/h, coverage_factor: 2}
    margin: {kind: absolute, value: 1, unit: mph, above: value}
    rounding: {mode: truncate, unit: km/h, decimals: 2}
    result: {mode: nearest, unit: km/h, decimals: 2}
    decision: {probability: 0.975}
    current: ignored
    uncertainty: {correlation_time_min_s: 0.5, correlation_time_max_s: 10, selection_bias: covered, fault_probability: 0.002, error_floor_m: {fixed: 0.02, float: 0.2}}
    signatures: [{role: measurer, count: 1}]
    clauses:
      - {id: window, text: an average, source: a book, edition: first, where: page 1, looked_at: "2026-01-01", certainty: quoted, decided_by: window_complete}
      - {id: accuracy, text: a limit, source: a book, certainty: quoted, decided_by: accuracy}
      - {id: rate, text: enough samples, source: a book, certainty: quoted, decided_by: sampling_rate, limit: 5, unit: Hz}
      - {id: wind, text: little wind, source: a book, certainty: quoted, decided_by: wind_mean, limit: 20, unit: kn}
      - {id: margin, text: more than the record, source: a book, certainty: quoted, decided_by: margin}
      - {id: second, text: another method, source: a book, certainty: quoted, decided_by: secondary_method, accepts: [velocities]}
    questions: [{id: why, text: "Why?", source: a book}]
  course:
    schema: profile/1.0
    id: course
    body: a body
    title: a title
    window: {kind: course, distance_m: 500, definition: elapsed_time}
    margin: {kind: elapsed_time, value: 0.01, unit: s}
    current: subtracted
    clauses:
      - {id: window, text: an average, source: a book, certainty: quoted, decided_by: window_complete}
)yaml";

/// More rules, of the other kinds of window.
inline constexpr const char* more_rules = R"yaml(
alpha:
  schema: profile/1.0
  id: alpha
  body: a body
  title: a title
  window: {kind: alpha, distance_m: 200, definition: path_length, proximity_m: 50, turn_deg: 90}
  speed_of: antenna
  margin: {kind: absolute, value: 0, unit: km/h}
  clauses: [{id: window, text: an average, source: a book, certainty: quoted, decided_by: window_complete}]
part:
  schema: profile/1.0
  id: part
  body: a body
  title: a title
  window: {duration_s: 2, definition: displacement, within: {from: {event: stated}, to: [{event: stated}]}}
  margin: {kind: absolute, value: 0, unit: km/h}
  arithmetic: {text: a sum, source: position, definition: displacement, rounding: {mode: nearest, unit: km/h, decimals: 2}}
  clauses: [{id: window, text: an average, source: a book, certainty: quoted, decided_by: window_complete}]
pair:
  schema: profile/1.0
  id: pair
  body: a body
  title: a title
  window: {duration_s: 2, definition: path_length}
  opposite_runs: {within_s: 600}
  margin: {kind: relative, value: 0.002}
  clauses: [{id: window, text: an average, source: a book, certainty: quoted, decided_by: window_complete}]
)yaml";

/// Keys that stand in place of others of the case above.
inline constexpr const char* other_way = R"yaml(
/attempt/record: null
/attempt/records: [{profile: time, speed: 50, unit: kn, source: a list, expanded_uncertainty: 0.1}]
/attempt/secondary: {method: video, source: a sheet, speed: 54, unit: kn, expanded_uncertainty: 0.2}
/attempt/receivers/0/lever_arm_m: null
/attempt/receivers/0/rotation_bound_deg: null
/attempt/receivers/0/surface: {file: ground.csv, triangles: triangles.csv, frame: {utm: {zone: 33, hemisphere: south}}, axes: east-north-up, unit: m, heights: geoid, undulation_m: 1.0, vertical_sd_m: 0.1, tilt_max_deg: 5.0, source: a survey}
/attempt/receivers/0/imu: {file: imu.csv, columns: {time: t, gyro_x: gx, gyro_y: gy, gyro_z: gz, accelerometer_x: ax, accelerometer_y: ay, accelerometer_z: az}, axes: {x: forward, y: right, z: down}, mount_deg: {roll: 1, pitch: 2, yaw: 3}, readings: rates, samples: instant, gyro_unit: rad/s, gyro_scale: 1, accelerometer_unit: m/s2, accelerometer_scale: 1, accelerometer_sense: specific_force, time_unit: s, rate_hz: 100, start_gps: "2026-10-20T11:00:58.000", time_offset_s: 0.1, grade: mems, antenna_m: {forward: 0.5, right: 0.1, down: -1.2}, reference_point_m: {forward: 0.1, right: 0.2, down: 0.3}, reference_point: the hull, arm_expanded_uncertainty_m: 0.05}
)yaml";

inline constexpr const char* other_way_changes = R"yaml(
- {key: "records[].profile", set: {/attempt/records/0/profile: course}}
- {key: "records[].speed", set: {/attempt/records/0/speed: 51}}
- {key: "records[].unit", set: {/attempt/records/0/unit: mph}}
- {key: "records[].source", set: {/attempt/records/0/source: another list}}
- {key: "records[].expanded_uncertainty", set: {/attempt/records/0/expanded_uncertainty: 0.5}}
- {key: secondary.speed, set: {/attempt/secondary/speed: 53}}
- {key: secondary.unit, set: {/attempt/secondary/unit: mph}}
- {key: secondary.expanded_uncertainty, set: {/attempt/secondary/expanded_uncertainty: 0.4}}
- {key: "receivers[].imu.file", set: {/attempt/receivers/0/imu/file: other-imu.csv}, redoes: import smooth window}
- {key: "receivers[].surface.file", set: {/attempt/receivers/0/surface/file: other-ground.csv}, redoes: import screen smooth}
- {key: "receivers[].surface.frame", set: {/attempt/receivers/0/surface/frame: geodetic}, redoes: import}
- {key: "receivers[].surface.frame.utm.zone", set: {/attempt/receivers/0/surface/frame/utm/zone: 34}, redoes: import}
- {key: "receivers[].surface.frame.utm.hemisphere", set: {/attempt/receivers/0/surface/frame/utm/hemisphere: north}, redoes: import}
- {key: "receivers[].surface.heights", set: {/attempt/receivers/0/surface/heights: ellipsoid, /attempt/receivers/0/surface/undulation_m: null}, redoes: import}
- {key: "receivers[].imu.columns.week", set: {/attempt/receivers/0/imu/columns/week: week}, redoes: import}
- {key: "receivers[].imu.axes.x", set: {/attempt/receivers/0/imu/axes: {x: -forward, y: -right, z: down}}, redoes: import}
- {key: "receivers[].imu.axes.y", set: {/attempt/receivers/0/imu/axes: {x: right, y: -forward, z: down}}, redoes: import}
- {key: "receivers[].imu.axes.z", set: {/attempt/receivers/0/imu/axes: {x: -forward, y: right, z: -down}}, redoes: import}
- {key: "receivers[].imu.start_gps", set: {/attempt/receivers/0/imu/start_gps: "2026-10-20T11:00:59.000"}, redoes: import}
- {key: "receivers[].imu.grade", set: {/attempt/receivers/0/imu/grade: tactical}, redoes: import}
- {key: "receivers[].imu.grade.gyro_bias_deg_h", set: {/attempt/receivers/0/imu/grade: {gyro_bias_deg_h: 2, angle_random_walk_deg_sqrt_h: 1, gyro_bias_walk_deg_h_sqrt_h: 1, accelerometer_bias_mg: 1, velocity_random_walk_m_s_sqrt_h: 1, accelerometer_bias_walk_mg_sqrt_h: 1}}, redoes: import}
- {key: "receivers[].imu.grade.angle_random_walk_deg_sqrt_h", set: {/attempt/receivers/0/imu/grade: {gyro_bias_deg_h: 1, angle_random_walk_deg_sqrt_h: 2, gyro_bias_walk_deg_h_sqrt_h: 1, accelerometer_bias_mg: 1, velocity_random_walk_m_s_sqrt_h: 1, accelerometer_bias_walk_mg_sqrt_h: 1}}, redoes: import}
- {key: "receivers[].imu.grade.gyro_bias_walk_deg_h_sqrt_h", set: {/attempt/receivers/0/imu/grade: {gyro_bias_deg_h: 1, angle_random_walk_deg_sqrt_h: 1, gyro_bias_walk_deg_h_sqrt_h: 2, accelerometer_bias_mg: 1, velocity_random_walk_m_s_sqrt_h: 1, accelerometer_bias_walk_mg_sqrt_h: 1}}, redoes: import}
- {key: "receivers[].imu.grade.accelerometer_bias_mg", set: {/attempt/receivers/0/imu/grade: {gyro_bias_deg_h: 1, angle_random_walk_deg_sqrt_h: 1, gyro_bias_walk_deg_h_sqrt_h: 1, accelerometer_bias_mg: 2, velocity_random_walk_m_s_sqrt_h: 1, accelerometer_bias_walk_mg_sqrt_h: 1}}, redoes: import}
- {key: "receivers[].imu.grade.velocity_random_walk_m_s_sqrt_h", set: {/attempt/receivers/0/imu/grade: {gyro_bias_deg_h: 1, angle_random_walk_deg_sqrt_h: 1, gyro_bias_walk_deg_h_sqrt_h: 1, accelerometer_bias_mg: 1, velocity_random_walk_m_s_sqrt_h: 2, accelerometer_bias_walk_mg_sqrt_h: 1}}, redoes: import}
- {key: "receivers[].imu.grade.accelerometer_bias_walk_mg_sqrt_h", set: {/attempt/receivers/0/imu/grade: {gyro_bias_deg_h: 1, angle_random_walk_deg_sqrt_h: 1, gyro_bias_walk_deg_h_sqrt_h: 1, accelerometer_bias_mg: 1, velocity_random_walk_m_s_sqrt_h: 1, accelerometer_bias_walk_mg_sqrt_h: 2}}, redoes: import}
)yaml";

inline constexpr const char* claim_changes = R"yaml(
- {key: id, set: {/attempt/id: other}}
- {key: craft.class, set: {/attempt/craft/class: car}, redoes: screen smooth}
- {key: utc_offset, set: {/attempt/utc_offset: "-03:30"}}
- {key: date, set: {/attempt/date: "2026-10-21"}}
- {key: "officials[].role", set: {/attempt/officials/1/role: judge}}
- {key: "officials[].key", set: {/attempt/officials/0/key: a key}}
- {key: "signatures[].role", set: {/attempt/signatures/0/role: judge}}
- {key: amends.report_id, set: {/attempt/amends/report_id: 0123456789abcdee}}
- {key: amends.sha256, set: {/attempt/amends/sha256: 1123456789abcdef0123456789abcdef0123456789abcdef0123456789abcdef}}
- {key: decision_rule_agreed.date, set: {/attempt/decision_rule_agreed/date: "2026-10-02"}}
- {key: record.unit, set: {/attempt/record/unit: mph}}
- {key: record.expanded_uncertainty, set: {/attempt/record/expanded_uncertainty: 0.3}}
- {key: "rules[].profile", set: {/attempt/rules/0/profile: course}}
- {key: "rules[].figure", set: {/attempt/rules/0/figure: decision.probability}}
- {key: "rules[].value", set: {/attempt/rules/0/value: 0.8}}
- {key: "rules[].value", set: {/attempt/rules/1/value: 2.4}, redoes: window}
- {key: "rules[].figure", set: {/attempt/rules/1/figure: accuracy.limit}, redoes: window}
- {key: rules, set: {/attempt/rules: null}, redoes: window}
- {key: part.from_utc, set: {/attempt/part/from_utc: "2026-10-20T10:59:01.000"}, redoes: window}
- {key: part.to_utc, set: {/attempt/part/to_utc: "2026-10-20T11:30:01.000"}, redoes: window}
- {key: wind.file, set: {/attempt/wind/file: current.csv}}
- {key: current.file, set: {/attempt/current/file: wind.csv}}
- {key: secondary.start_utc, set: {/attempt/secondary/start_utc: "2026-10-20T11:00:41.535"}}
- {key: secondary.finish_utc, set: {/attempt/secondary/finish_utc: "2026-10-20T11:00:59.397"}}
- {key: "profiles[]", set: {/attempt/profiles/1: null, /attempt/rules/1: null}, redoes: window}
- {key: origin, set: {/attempt/origin: null}, redoes: enu}
- {key: "parameters.screen.allowed_fixes", set: {/attempt/parameters/screen/allowed_fixes: [fixed, float]}, redoes: screen}
- {key: "parameters.screen.allowed_fixes[]", set: {/attempt/parameters/screen/allowed_fixes: [float]}, redoes: screen}
)yaml";

inline constexpr const char* receiver_changes = R"yaml(
- {key: "receivers[].antenna_motion.height_m", set: {/attempt/receivers/1/antenna_motion/height_m: 3}, redoes: window}
- {key: "receivers[].antenna_motion.roll_deg", set: {/attempt/receivers/1/antenna_motion/roll_deg: 6}, redoes: window}
- {key: "receivers[].antenna_motion.pitch_deg", set: {/attempt/receivers/1/antenna_motion/pitch_deg: 3}, redoes: window}
- {key: "receivers[].antenna_motion.roll_period_s", set: {/attempt/receivers/1/antenna_motion/roll_period_s: 4}, redoes: window}
- {key: "receivers[].antenna_motion.leeway_deg", set: {/attempt/receivers/1/antenna_motion/leeway_deg: 5}, redoes: window}
- {key: "receivers[].id", set: {/attempt/receivers/1/id: third}, redoes: import enu screen smooth window}
- {key: receivers, set: {/attempt/receivers/1: null}, redoes: import enu screen smooth window}
- {key: "receivers[].recording", set: {/attempt/receivers/0/recording: b.pos}, redoes: import}
- {key: "receivers[].recording[]", set: {/attempt/receivers/0/recording: [a.pos, b.pos]}, redoes: import}
- {key: "receivers[].format", set: {/attempt/receivers/0/format: csv}, redoes: import}
- {key: "receivers[].gpsbabel_type", set: {/attempt/receivers/0/gpsbabel_type: kml}, redoes: import}
- {key: "receivers[].base", set: {/attempt/receivers/0/base: b.pos}, redoes: import screen window}
- {key: "receivers[].navigation", set: {/attempt/receivers/0/navigation: b.pos}, redoes: import}
- {key: "receivers[].navigation[]", set: {/attempt/receivers/0/navigation: [b.pos, a.pos]}, redoes: import}
- {key: "receivers[].phase", set: {/attempt/receivers/0/phase: b.pos}, redoes: import screen window}
- {key: "receivers[].base_position.latitude_deg", set: {/attempt/receivers/0/base_position: {latitude_deg: 1, longitude_deg: 2, height_m: 3}}, redoes: import}
- {key: "receivers[].base_position.longitude_deg", set: {/attempt/receivers/0/base_position: {latitude_deg: 1, longitude_deg: 3, height_m: 3}}, redoes: import}
- {key: "receivers[].base_position.height_m", set: {/attempt/receivers/0/base_position: {latitude_deg: 1, longitude_deg: 2, height_m: 4}}, redoes: import}
- {key: "receivers[].utc_offset_h", set: {/attempt/receivers/0/utc_offset_h: 2}, redoes: import}
- {key: "receivers[].start_date", set: {/attempt/receivers/0/start_date: "2026-10-20"}, redoes: import}
- {key: "receivers[].frame", set: {/attempt/receivers/0/frame: ecef}, redoes: import}
- {key: "receivers[].frame.utm.zone", set: {/attempt/receivers/0/frame: {utm: {zone: 33, hemisphere: south}}}, redoes: import}
- {key: "receivers[].frame.utm.hemisphere", set: {/attempt/receivers/0/frame: {utm: {zone: 33, hemisphere: north}}}, redoes: import}
- {key: "receivers[].time_format", set: {/attempt/receivers/0/time_format: iso}, redoes: import}
- {key: "receivers[].time_scale", set: {/attempt/receivers/0/time_scale: utc}, redoes: import}
- {key: "receivers[].speed_unit", set: {/attempt/receivers/0/speed_unit: km/h}, redoes: import}
- {key: "receivers[].delimiter", set: {/attempt/receivers/0/delimiter: tab}, redoes: import}
- {key: "receivers[].start_gps", set: {/attempt/receivers/0/start_gps: "2026-10-20T11:00:00.000"}, redoes: import}
- {key: "receivers[].height_m", set: {/attempt/receivers/0/height_m: 30}, redoes: import}
- {key: "receivers[].accuracy.horizontal_m", set: {/attempt/receivers/0/accuracy: {horizontal_m: 0.02}}, redoes: import}
- {key: "receivers[].accuracy.velocity_mps", set: {/attempt/receivers/0/accuracy: {velocity_mps: 0.2}}, redoes: "import window"}
- {key: "receivers[].accuracy.vertical_m", set: {/attempt/receivers/0/accuracy: {horizontal_m: 0.02, vertical_m: 0.03}}, redoes: import}
- {key: "receivers[].solution", set: {/attempt/receivers/0/solution: float}, redoes: import}
- {key: "receivers[].calibration.date", set: {/attempt/receivers/0/calibration/date: "2026-09-02"}}
- {key: "receivers[].calibration.unit", set: {/attempt/receivers/0/calibration/unit: kn}, redoes: window}
- {key: "receivers[].calibration.of", set: {/attempt/receivers/0/calibration/of: time, /attempt/receivers/0/calibration/unit: s}, redoes: window}
- {key: "receivers[].height_reference.geoid", set: {/attempt/receivers/0/height_reference: {geoid: egm96}}, redoes: import}
- {key: "receivers[].receipt.file", set: {/attempt/receivers/0/receipt: {file: receipt.json}}, redoes: import}
- {key: "receivers[].receipt.time_stamp", set: {/attempt/receivers/0/receipt: {file: receipt.json, time_stamp: receipt.json.tsr}}, redoes: import}
- {key: "receivers[].time_source", set: {/attempt/receivers/0/time_source: satellites}, redoes: import}
)yaml";

/// What no value of its own kind alone can stand for: the walk over the field table does the rest.
inline constexpr const char* profile_changes = R"yaml(
- {key: looked_at, set: {/rules/time/looked_at: "2026-01-02"}}
- {key: superseded_from, set: {/rules/time/superseded_by: another-rule, /rules/time/superseded_from: "2026-01-02"}}
- {key: valid_from, set: {/rules/time/valid_from: "2026-01-02"}}
- {key: "clauses[].looked_at", set: {/rules/time/clauses/0/looked_at: "2026-01-02"}}
- {key: evidence, set: {/rules/alpha: {schema: profile/1.0, id: alpha, body: a body, title: a title, evidence: true, clauses: [{id: seen, text: a witness, source: a book, certainty: quoted, decided_by: attest}]}}, redoes: window}
- {key: window.within.from.event, set: {/rules/part/window/within/from: {event: at_height, height_m: 5000}}, redoes: window}
- {key: window.within.from.speed_m_s, set: {/rules/part/window/within/from: {event: exit, speed_m_s: 12}}, redoes: window}
- {key: window.within.from.height_m, set: {/rules/part/window/within/from: {event: at_height, height_m: 4000}}, redoes: window}
- {key: "window.within.to[].event", set: {/rules/part/window/within/to/0: {event: at_height, height_m: 10}}, redoes: window}
- {key: "window.within.to[].speed_m_s", set: {/rules/part/window/within/to/0: {event: exit, speed_m_s: 12}}, redoes: window}
- {key: "window.within.to[].height_m", set: {/rules/part/window/within/to/0: {event: at_height, height_m: 20}}, redoes: window}
- {key: window.within.validation_m, set: {/rules/part/window/within/validation_m: 100}, redoes: window}
- {key: arithmetic.text, set: {/rules/part/arithmetic/text: another sum}, redoes: window}
- {key: arithmetic.source, set: {/rules/part/arithmetic/source: velocity, /rules/part/arithmetic/definition: mean_n}, redoes: window}
- {key: arithmetic.definition, set: {/rules/part/arithmetic/definition: path_length}, redoes: window}
- {key: arithmetic.rounding.mode, set: {/rules/part/arithmetic/rounding/mode: truncate}, redoes: window}
- {key: arithmetic.rounding.unit, set: {/rules/part/arithmetic/rounding/unit: kn}, redoes: window}
- {key: arithmetic.rounding.decimals, set: {/rules/part/arithmetic/rounding/decimals: 1}, redoes: window}
- {key: margin.kind, set: {/rules/course/margin: {kind: absolute, value: 0.01, unit: kn}}}
- {key: margin.unit, set: {/rules/time/margin/unit: kn}}
- {key: current, set: {/rules/time/current: subtracted}}
- {key: current, set: {/rules/course/current: ignored}}
- {key: "signatures[].role", set: {/rules/time/signatures/0/role: judge}}
- {key: "clauses[].id", set: {/rules/time/clauses/0/id: stretch}}
- {key: "clauses[].decided_by", set: {/rules/alpha/clauses/0/decided_by: attest}, redoes: window}
- {key: "clauses[].limit", set: {/rules/time/clauses/2/limit: 6}, redoes: window}
- {key: "clauses[].accepts[]", set: {/rules/time/clauses/5/accepts: [phases]}}
- {key: "clauses[].unit", set: {/rules/time/clauses/3/unit: m/s}}
- {key: "clauses[].answered_by.role", set: {/rules/time/clauses/0/answered_by: {role: board}}}
- {key: "clauses[].answered_by.count", set: {/rules/time/clauses/0/answered_by: {count: 2}}}
- {key: window.kind, set: {/rules/time/window: {kind: distance, distance_m: 100, definition: displacement}, /attempt/rules: null}, redoes: window}
- {key: window.duration_s, set: {/rules/time/window/duration_s: 4}, redoes: window}
- {key: window.distance_m, set: {/rules/alpha/window/distance_m: 250}, redoes: window}
- {key: window.definition, set: {/rules/time/window/definition: path_length}, redoes: window}
- {key: window.dimension, set: {/rules/time/window/dimension: space, /rules/time/window/definition: displacement}, redoes: window}
- {key: window.source, set: {/rules/pair/window/source: velocity}, redoes: window}
- {key: window.ends, set: {/rules/time/window/ends: any, /rules/time/window/exact: false}, redoes: window}
- {key: window.exact, set: {/rules/time/window/exact: true}, redoes: window}
- {key: window.count, set: {/rules/time/window/count: 2}, redoes: window}
- {key: window.proximity_m, set: {/rules/alpha/window/proximity_m: 40}, redoes: window}
- {key: window.turn_deg, set: {/rules/alpha/window/turn_deg: 80}, redoes: window}
- {key: speed_of, set: {/rules/alpha/speed_of: reference_point}, redoes: window}
- {key: opposite_runs.within_s, set: {/rules/pair/opposite_runs/within_s: 700}, redoes: window}
)yaml";

}  // namespace runcert::chain
