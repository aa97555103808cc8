#pragma once

#include <span>
#include <vector>

#include "stages/window/best_window.h"
#include "stages/window/craft_speeds.h"
#include "stages/window/lasting_difference.h"
#include "stages/window/window.h"
#include "stages/window/witnesses.h"
#include "witness/arcs.h"
#include "witness/certifiable.h"
#include "witness/window_speed.h"

namespace runcert {

struct Contradiction;

/// The data from which windows are certified, for horizontal speeds (Axes 2) or vertical ones (1).
template <int Axes>
struct AxesEstimate {
    const ScreenedTable& screened;
    const TrajectoryTable& trajectory;
    const WindowConfig& config;
    const NoiseSummary& noise;
    EstimationModel model;              ///< of the trajectory
    std::vector<WeightedModel> models;  ///< models that the recording supports
    std::vector<Arc<Axes>> arcs;
    std::vector<ArcRows> rows;                    ///< each arc's rows in the trajectory
    std::vector<std::vector<ElapsedTime>> times;  ///< of each arc's epochs
    AssessedWitnesses<Axes> witnesses;
    AssessedWitnesses<Axes> unattested;  ///< the same before officials have attested second files
    std::vector<Stand> stands;
    LastingDifference lasting;  ///< as from `lasting_difference`
};

/// The witnesses that count before officials have attested second files, or after.
template <int Axes>
const AssessedWitnesses<Axes>& admitted_witnesses(const AxesEstimate<Axes>& estimate,
                                                  bool files_attested) {
    return files_attested ? estimate.witnesses : estimate.unattested;
}

/// Gathers these data, with where the craft stood (`stands_of`). Heights must have been measured
/// for Axes 1. Failure if the trajectory does not have the arcs of the screened epochs, or does not
/// state the noise with which it was estimated.
template <int Axes>
AxesEstimate<Axes> estimate_of(const ScreenedTable& screened, const TrajectoryTable& trajectory,
                               const WindowConfig& config, const WitnessRecords& records,
                               std::vector<Stand> stands);

/// How much of a certificate is made: all of it, or as much as comparing windows needs, without the
/// bias of the choice and the Monte Carlo check.
enum class CertificateExtent { whole, to_compare };

/// A window that was found, and the windows from which it was chosen.
struct WindowChoice {
    const Profile& profile;
    const FoundWindow& found;
    const std::vector<FoundWindow>& all;  ///< all the windows that it was chosen from, itself
                                          ///< included
    SpeedQuantity quantity;
    double length_standard_uncertainty_m = 0.0;  ///< of quantity.length_m, for a course
    /// From the antenna's speed to the craft's, where the rule counts that.
    std::optional<CraftCorrection> craft = std::nullopt;
    /// Whether witnesses can only contradict: they do not reduce the uncertainty.
    bool by_positions_alone = false;
    bool files_attested = true;  ///< whether an official has answered for second files
    /// Where witnesses contradict other windows, which makes this one suspect.
    std::span<const Contradiction> contradictions = {};
    CertificateExtent extent = CertificateExtent::whole;
};

/// A window with its place and time, without figures.
CertifiableWindow window_at(const TrajectoryTable& trajectory, const ArcRows& arc,
                            const FoundWindow& found);

/// Sets a window's speed: the measured one less `bias_m_s` of the choice, where the rule subtracts
/// it, and as the limit what may remain of it for a source that counts by this share.
void set_speed(double measured_m_s, const SelectionBias& selection, double bias_m_s, double share,
               CertifiableWindow& window);

/// Sets the combined uncertainty of a window by its budget.
void set_uncertainty(CertifiableWindow& window);

/// The quantity by which a profile's windows are certified. For a course, the caller adds its
/// length and lines.
SpeedQuantity quantity_of(const Profile& profile);

/// The measured speed of a window with all sources of uncertainty. A vertical speed is of
/// ellipsoidal heights. Speeds by witnesses are given with it. Where they agree, the budget
/// contains the uncertainty that they leave (`combine_with_witnesses`). Failure if the trajectory
/// is not the estimate from these screened epochs.
template <int Axes>
CertifiableWindow certify_by_positions(const AxesEstimate<Axes>& estimate,
                                       const WindowChoice& choice);

/// The speed in space of a window, from its horizontal and vertical displacement. The two are at
/// right angles. Their errors are taken as fully correlated, because their correlation is unknown.
/// Both were certified by positions alone.
CertifiableWindow speed_in_space(const CertifiableWindow& horizontal,
                                 const CertifiableWindow& vertical);

}  // namespace runcert
