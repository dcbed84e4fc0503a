#pragma once
/// \file
/// Counters of the statuses, listed once for every consumer that shows them.

#include <sonopose/samples/status.hpp>

#include <array>
#include <cstdint>
#include <string_view>

namespace sonopose::observation {

template <class Status>
struct StatusCounter {
  std::string_view name;  ///< name of the field
  std::uint64_t Status::*value;
  std::string_view problem = {};   ///< singular; empty if the count is no sign of a fault
  std::string_view problems = {};  ///< plural
};

inline constexpr std::array bridge_counters{
    StatusCounter<BeaconStatus>{"frames", &BeaconStatus::frames},
    StatusCounter<BeaconStatus>{"crc_errors", &BeaconStatus::crc_errors, "damaged frame", "damaged frames"},
    StatusCounter<BeaconStatus>{"bytes_lost", &BeaconStatus::bytes_lost},
    StatusCounter<BeaconStatus>{"unknown_frames", &BeaconStatus::unknown_frames},
    StatusCounter<BeaconStatus>{"fixes_unavailable", &BeaconStatus::fixes_unavailable},
    StatusCounter<BeaconStatus>{"samples_rejected", &BeaconStatus::samples_rejected, "unusable sample",
                                "unusable samples"},
    StatusCounter<BeaconStatus>{"clock_resets", &BeaconStatus::clock_resets, "clock reset", "clock resets"},
    StatusCounter<BeaconStatus>{"imu_deadlines_missed", &BeaconStatus::imu_deadlines_missed,
                                "IMU deadline missed", "IMU deadlines missed"},
    StatusCounter<BeaconStatus>{"fix_deadlines_missed", &BeaconStatus::fix_deadlines_missed,
                                "fix deadline missed", "fix deadlines missed"},
    StatusCounter<BeaconStatus>{"heading_deadlines_missed", &BeaconStatus::heading_deadlines_missed,
                                "heading deadline missed", "heading deadlines missed"},
    StatusCounter<BeaconStatus>{"liveliness_lost", &BeaconStatus::liveliness_lost, "liveliness loss",
                                "liveliness losses"},
    StatusCounter<BeaconStatus>{"readers_incompatible", &BeaconStatus::readers_incompatible,
                                "incompatible reader", "incompatible readers"},
    StatusCounter<BeaconStatus>{"samples_unwritten", &BeaconStatus::samples_unwritten, "sample not written",
                                "samples not written"},
    StatusCounter<BeaconStatus>{"samples_unrecorded", &BeaconStatus::samples_unrecorded,
                                "sample not recorded", "samples not recorded"}};

inline constexpr std::array fusion_counters{
    StatusCounter<FusionStatus>{"imu_samples", &FusionStatus::imu_samples},
    StatusCounter<FusionStatus>{"fixes_used", &FusionStatus::fixes_used},
    StatusCounter<FusionStatus>{"fixes_down_weighted", &FusionStatus::fixes_down_weighted},
    StatusCounter<FusionStatus>{"fixes_rejected", &FusionStatus::fixes_rejected},
    StatusCounter<FusionStatus>{"fixes_late", &FusionStatus::fixes_late, "fix too late", "fixes too late"},
    StatusCounter<FusionStatus>{"headings", &FusionStatus::headings},
    StatusCounter<FusionStatus>{"velocities_used", &FusionStatus::velocities_used},
    StatusCounter<FusionStatus>{"velocities_rejected", &FusionStatus::velocities_rejected},
    StatusCounter<FusionStatus>{"velocities_unused", &FusionStatus::velocities_unused},
    StatusCounter<FusionStatus>{"imu_deadlines_missed", &FusionStatus::imu_deadlines_missed,
                                "IMU deadline missed", "IMU deadlines missed"},
    StatusCounter<FusionStatus>{"fix_deadlines_missed", &FusionStatus::fix_deadlines_missed,
                                "fix deadline missed", "fix deadlines missed"},
    StatusCounter<FusionStatus>{"heading_deadlines_missed", &FusionStatus::heading_deadlines_missed,
                                "heading deadline missed", "heading deadlines missed"},
    StatusCounter<FusionStatus>{"events_lost", &FusionStatus::events_lost, "event lost", "events lost"},
    StatusCounter<FusionStatus>{"events_duplicated", &FusionStatus::events_duplicated},
    StatusCounter<FusionStatus>{"samples_invalid", &FusionStatus::samples_invalid, "sample invalid",
                                "samples invalid"},
    StatusCounter<FusionStatus>{"imu_gaps", &FusionStatus::imu_gaps, "IMU gap", "IMU gaps"},
    StatusCounter<FusionStatus>{"bridge_losses", &FusionStatus::bridge_losses, "bridge loss",
                                "bridge losses"},
    StatusCounter<FusionStatus>{"poses_late", &FusionStatus::poses_late, "late pose", "late poses"},
    StatusCounter<FusionStatus>{"poses_skipped", &FusionStatus::poses_skipped, "pose skipped",
                                "poses skipped"},
    StatusCounter<FusionStatus>{"pose_deadlines_missed", &FusionStatus::pose_deadlines_missed,
                                "pose deadline missed", "pose deadlines missed"},
    StatusCounter<FusionStatus>{"liveliness_lost", &FusionStatus::liveliness_lost, "liveliness loss",
                                "liveliness losses"},
    StatusCounter<FusionStatus>{"samples_lost", &FusionStatus::samples_lost, "sample lost", "samples lost"},
    StatusCounter<FusionStatus>{"samples_rejected", &FusionStatus::samples_rejected, "sample rejected",
                                "samples rejected"},
    StatusCounter<FusionStatus>{"incompatible_qos", &FusionStatus::incompatible_qos, "incompatible endpoint",
                                "incompatible endpoints"},
    StatusCounter<FusionStatus>{"poses_unwritten", &FusionStatus::poses_unwritten, "pose not written",
                                "poses not written"}};

}  // namespace sonopose::observation
