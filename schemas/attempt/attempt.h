#pragma once

#include <cstddef>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "schemas/attempt/declared.h"
#include "schemas/common/header.h"
#include "store/opaque_json.h"

namespace runcert {

/// Whether raw phases are handed in: in a file of their own, or as a RINEX recording.
inline bool has_phases(const Receiver& receiver) {
    return !receiver.phase.empty() || !receiver.base.empty();
}

/// Whether an IMU was recorded beside the positions.
inline bool has_imu(const Receiver& receiver) {
    return receiver.imu.has_value();
}

/// Whether the surface that the craft runs on is handed in.
inline bool has_surface(const Receiver& receiver) {
    return receiver.surface.has_value();
}

/// A direction of the craft as a component of forward, right, down (0 to 2), and its sign.
struct CraftDirection {
    std::size_t component = 0;
    double sign = 1.0;
};
CraftDirection direction_of(CraftAxis axis);

/// Something that the attempt says or hands in, and that can change what is certified.
struct AttemptInput {
    std::string name;     ///< "receivers.primary.solution", "records.nalsa.speed"
    std::string profile;  ///< whose it is alone; empty for that of every profile
    FieldOrigin origin;   ///< as its field declares it
    std::string value;    ///< as the attempt has it, with its unit
};

/// An attempt, `schemas/attempt/v1.yaml`: one receiver at least, the first is the one that is
/// judged.
struct Attempt : AttemptDocument {
    std::map<std::string, Record> records = {};  ///< by profile
    /// Local time less UTC; nothing where the attempt does not say it.
    std::optional<int> utc_offset_minutes = std::nullopt;
    /// Every one resolved: the attempt's figure, or the default of the craft's class.
    Parameters parameters = {};
    /// The document with these in it, that the part of a stage is taken from.
    YamlValue resolved{YamlNode(), ""};
    /// Paths of the parameters that the attempt sets itself ("smooth.jerk_density").
    std::vector<std::string> overrides = {};
    /// Everything in it that its fields declare to change something and that is not the default, in
    /// the order of the file. What changes the outcome is stated where its default holds, too.
    std::vector<AttemptInput> inputs = {};

    /// The record to beat under the profile of that name; null where there is none.
    const Record* record_for(const std::string& profile) const;
    /// The receiver of that id as the document has it.
    YamlValue written(const std::string& receiver) const;
};

/// What a stage reads of an attempt, by the declaration of its fields (`read_by`). All else is as
/// in an attempt that does not say it.
Attempt part_read_by(const Attempt& attempt, std::string_view stage);

/// The same as the attempt has it, parameters resolved: what the stage's files depend on beside the
/// files that it reads.
OpaqueJson settings_of(const Attempt& attempt, std::string_view stage);

/// A stage's own parameters, as its header has them; none for a stage that has none.
OpaqueJson parameters_of(const Attempt& attempt, const std::string& stage);

/// How a receiver's recording is to be read, as the attempt has it: what is imported of it but its
/// id, the names of files, and what stands beside the recording with a file of its own ("imu",
/// "surface"); that, too, where it is named.
OpaqueJson reading_of(const YamlValue& receiver, std::string_view beside = {});

/// A file that an attempt's keys name.
struct NamedFile {
    std::string key;  ///< "recording"
    std::string name;
};
/// All of them, in the order of the field table; a name that is not text is passed over.
std::vector<NamedFile> named_files(const YamlValue& keys);

/// What an attempt says or hands in, `Attempt::inputs`: `document` was checked by the schema.
std::vector<AttemptInput> inputs_of(const YamlValue& document);

/// Reads and checks an attempt. Failure with file, line, column and remedy on any deviation from
/// the schema, two receivers with one id, an unusable id, or a bad date or offset from UTC.
Attempt read_attempt(std::string_view text, const std::string& where,
                     Completeness completeness = Completeness::whole);

const DocumentSchema& attempt_schema();

/// The names of a receiver's recordings, without folders, "a.nmea, b.nmea".
std::string recording_names(const Receiver& receiver);

/// The profiles that a name claims: itself, or those of one body that are claimed together
/// (gps-speed-sailing, gps-ice-sailing).
std::vector<std::string> claimed_by(const std::string& name);

/// The name by which a profile claimed in an attempt is known in the run folder: "nalsa" of
/// "nalsa", "my-rule" of "rules/my-rule.yaml".
std::string profile_name(const std::string& claimed);

}  // namespace runcert
