#pragma once

#include <fcntl.h>
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/text.h"
#include "daemon_support.h"
#include "store/atomic_file.h"
#include "store/process.h"

namespace runcert::chain {

/// A value of the environment for the object's life.
class EnvironmentValue {
  public:
    EnvironmentValue(std::string name, const std::string& value) : name_(std::move(name)) {
        if (const char* old = std::getenv(name_.c_str())) old_ = old;
        setenv(name_.c_str(), value.c_str(), 1);
    }
    ~EnvironmentValue() {
        if (old_)
            setenv(name_.c_str(), old_->c_str(), 1);
        else
            unsetenv(name_.c_str());
    }
    EnvironmentValue(const EnvironmentValue&) = delete;
    EnvironmentValue& operator=(const EnvironmentValue&) = delete;

  private:
    std::string name_;
    std::optional<std::string> old_ = {};
};

/// Ports that nobody listens on, as of now.
inline std::vector<int> free_ports(std::size_t count) {
    std::vector<int> sockets;
    std::vector<int> ports;
    for (std::size_t i = 0; i < count; ++i) {
        sockets.push_back(socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0));
        sockaddr_in address{};
        address.sin_family = AF_INET;
        address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
        socklen_t size = sizeof address;
        bind(sockets.back(), reinterpret_cast<sockaddr*>(&address), size);
        getsockname(sockets.back(), reinterpret_cast<sockaddr*>(&address), &size);
        ports.push_back(ntohs(address.sin_port));
    }
    for (const int each : sockets)
        close(each);
    return ports;
}

/// A Slurm of this test's own: one controller and three nodes of two processors each on this
/// machine, with a munge of their own. All they write is in a temporary folder, they listen on free
/// ports, and need no rights but the user's, so that several can run side by side.
class SlurmCluster {
  public:
    /// `settings`: more lines of slurm.conf. Where the nodes are not ready after minutes, why_not()
    /// says so.
    explicit SlurmCluster(const std::string& settings = "") {
        for (const char* program : {"munged", "slurmctld", "slurmd", "sbatch"})
            if (!is_installed(program)) {
                why_not_ = fmt::format("Slurm is not installed: no {} (slurm-wlm, munge)", program);
                return;
            }
        write_munge_key();
        write_configuration(settings);
        start();
        if (!holds_within(240, [this] { return count_nodes("idle") == 3; }))
            why_not_ = "Slurm does not start here:\n" + logs();
    }

    ~SlurmCluster() {
        if (why_not_.empty()) {
            run_process({"scancel", "--state=PENDING", "--user=" + user()});
            run_process({"scancel", "--user=" + user()});
            holds_within(120, [] { return run_process({"squeue", "--noheader"}).output.empty(); });
        }
        if (testing::Test::HasFailure()) ADD_FAILURE() << logs();
        while (!daemons_.empty())
            daemons_.pop_back();
    }
    SlurmCluster(const SlurmCluster&) = delete;
    SlurmCluster& operator=(const SlurmCluster&) = delete;

    /// Why there is no cluster; empty where there is one.
    const std::string& why_not() const { return why_not_; }

    std::size_t count_nodes(std::string_view state) const {
        const std::string nodes =
            run_process({"sinfo", "--noheader", "--Node", "--format=%T"}).output;
        std::size_t count = 0;
        for (std::size_t at = 0; at < nodes.size(); at = nodes.find('\n', at) + 1)
            if (std::string_view(nodes).substr(at, nodes.find('\n', at) - at) == state) ++count;
        return count;
    }

    /// Takes a node (n1, n2 or n3) out, as its failure would: what runs there is begun again on
    /// another.
    void take_down(const std::string& node) const {
        const ProcessResult result = run_process(
            {"scontrol", "update", "NodeName=" + node, "State=DOWN", "Reason=the test's"});
        EXPECT_EQ(result.exit_status, 0) << result.errors;
    }

    bool runs_on(const std::string& node) const {
        return !run_process({"squeue", "--noheader", "--states=RUNNING", "--nodelist=" + node})
                    .output.empty();
    }

    /// The ends of what the daemons wrote.
    std::string logs() const {
        std::string text;
        for (const char* name : {"munged", "slurmctld", "n1", "n2", "n3"}) {
            const std::filesystem::path file = folder_.path() / (std::string(name) + ".log");
            if (!std::filesystem::exists(file)) continue;
            const std::string log = read_file(file);
            constexpr std::size_t shown = 4000;
            text += fmt::format("--- {}\n{}\n", name,
                                log.substr(log.size() - std::min(log.size(), shown)));
        }
        return text;
    }

  private:
    static std::string output_of(const std::vector<std::string>& command) {
        return std::string(trim(run_process(command).output));
    }
    static std::string user() { return output_of({"id", "-un"}); }

    static bool is_installed(const std::string& program) {
        return run_process({"sh", "-c", "command -v " + program}).exit_status == 0;
    }

    std::string path(std::string_view name) const { return (folder_.path() / name).string(); }

    void write_munge_key() const {
        std::string key(128, '\0');
        const int random = open("/dev/urandom", O_RDONLY | O_CLOEXEC);
        EXPECT_EQ(read(random, key.data(), key.size()), static_cast<ssize_t>(key.size()));
        close(random);
        write_file_atomically(path("munge.key"), key, FileAccess::owner_only);
    }

    // A task of a failed node is begun again only when its credential has run out: cred_expire, 120
    // s where it is not set. What waits for a time is looked at every sched_interval, else 60 s.
    void write_configuration(const std::string& settings) const {
        make_directory(path("state"));
        const std::string host = output_of({"uname", "-n"});
        const std::vector<int> ports = free_ports(4);
        std::string text = fmt::format(
            "ClusterName=test\nSlurmctldHost={0}(127.0.0.1)\nSlurmctldPort={1}\n"
            "SlurmUser={2}\nSlurmdUser={2}\nAuthInfo=socket={3}/munge.socket,cred_expire=5\n"
            "StateSaveLocation={3}/state\nSlurmdSpoolDir={3}/spool.%n\n"
            "SlurmctldPidFile={3}/slurmctld.pid\nSlurmdPidFile={3}/%n.pid\n"
            "ProctrackType=proctrack/linuxproc\nTaskPlugin=task/none\nMpiDefault=none\n"
            "SelectType=select/cons_tres\nSelectTypeParameters=CR_Core\n"
            "JobAcctGatherType=jobacct_gather/none\nMailProg=/bin/true\n"
            "JobRequeue=1\nReturnToService=0\nSlurmdTimeout=10\nKillWait=2\n"
            "SchedulerParameters=sched_interval=1,bf_interval=1,bf_resolution=1\n"
            "SlurmdParameters=config_overrides\n{4}\n",
            host, ports[0], user(), folder_.path().string(), settings);
        for (std::size_t node = 1; node <= 3; ++node)
            text += fmt::format(
                "NodeName=n{} NodeHostname={} NodeAddr=127.0.0.1 Port={} CPUs=2 RealMemory=4000\n",
                node, host, ports[node]);
        text += "PartitionName=batch Nodes=n[1-3] Default=YES State=UP\n";
        write_file_atomically(path("slurm.conf"), text);
    }

    void run_beside(std::vector<std::string> command, std::string_view name) {
        daemons_.push_back(
            std::make_unique<Daemon>(std::move(command), path(std::string(name) + ".log")));
    }

    void start() {
        run_beside({"munged", "--foreground", "--force", "--key-file=" + path("munge.key"),
                    "--socket=" + path("munge.socket"), "--pid-file=" + path("munged.pid"),
                    "--log-file=" + path("munged.log"), "--seed-file=" + path("munge.seed")},
                   "munged");
        holds_within(120, [this] { return std::filesystem::exists(path("munge.socket")); });
        run_beside({"slurmctld", "-D", "-f", path("slurm.conf")}, "slurmctld");
        for (const char* node : {"n1", "n2", "n3"})
            run_beside({"slurmd", "-D", "-N", node, "-f", path("slurm.conf")}, node);
    }

    TemporaryFolder folder_;
    // The daemons are where only root's PATH leads.
    EnvironmentValue search_{"PATH", std::string(std::getenv("PATH")) + ":/usr/sbin:/sbin"};
    EnvironmentValue configuration_{"SLURM_CONF", (folder_.path() / "slurm.conf").string()};
    std::vector<std::unique_ptr<Daemon>> daemons_ = {};
    std::string why_not_ = {};
};

}  // namespace runcert::chain
