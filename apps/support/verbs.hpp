#pragma once
// Every program, with the sentence that its own --help and the list of sonopose show.

#include <array>
#include <string_view>

namespace sonopose::apps {

/// A verb: `sonopose VERB` runs the program `sonopose-VERB`.
struct Verb {
  std::string_view name;
  std::string_view description;
};

inline constexpr std::array verbs{
    Verb{"run", "Runs bridge, fusion and monitor in one terminal and ends them together."},
    Verb{"bridge", "Publishes the samples of Marvelmind beacons, of a recording or of the simulator."},
    Verb{"fusion", "Fuses IMU samples and ultrasonic fixes into a pose for every beacon on the bus."},
    Verb{"monitor", "Shows the rates, pose, status and latency of every beacon once a second."},
    Verb{"web", "Serves a live page of every beacon for the browser, and all topics for Foxglove."},
    Verb{"ros2", "Publishes poses and samples as ROS 2 messages, and reads the samples of ROS 2 drivers."},
    Verb{"mavlink", "Sends the poses of a beacon to an autopilot over MAVLink."},
    Verb{"record", "Records the topics on the bus to MCAP files."},
    Verb{"play", "Publishes a recording in MCAP as it was received."},
    Verb{"doctor", "Diagnoses a running system and suggests remedies."},
    Verb{"settings", "Shows and changes the settings of a running sonopose-fusion."},
    Verb{"security", "Makes and checks the keys and permissions of a bus with DDS Security."},
    Verb{"simulate", "Writes a run of the built-in simulator, with its truth, as a sensor-log folder."},
    Verb{"import", "Makes a sensor-log folder of tables of an IMU and of positions."},
    Verb{"mcap", "Shows, selects, merges, repairs and exports recordings of the bus."},
    Verb{"replay", "Runs the fusion over a recording, without DDS, and scores it."},
    Verb{"evaluate", "Scores the fused pose on the simulator's scenarios and on recordings."},
    Verb{"tune", "Searches for settings with a smaller error on scenarios and on recordings."},
    Verb{"attitude", "Runs an attitude filter over recordings and scores it where the truth is known."},
    Verb{"calibrate", "Computes the errors of a beacon's sensors and of its mounting from recordings."},
};

}  // namespace sonopose::apps
