#include <fmt/format.h>

#include <filesystem>

#include "commands.h"
#include "core/failure.h"
#include "run/run_lock.h"
#include "store/atomic_file.h"
#include "store/process.h"
#include "trust/receipt.h"
#include "trust/signature_files.h"
#include "trust/time_stamp.h"
#include "trust/verification.h"

namespace runcert {
namespace {

namespace fs = std::filesystem;

struct TimestampOptions {
    std::string run_dir;
    std::string reply;
    std::vector<std::string> cas;
};

/// Writes the query of each signature that has no stamp; one that was written earlier stays, since
/// its reply may be under way.
int write_queries(const fs::path& run_dir, const std::vector<SignatureFile>& signatures,
                  const std::string& given) {
    bool sent = false;
    for (const SignatureFile& signature : signatures) {
        const fs::path stamp = run_dir / time_stamp_name(signature.name);
        const fs::path query = run_dir / time_stamp_query_name(signature.name);
        if (fs::exists(stamp)) {
            fmt::print("stamped  {}\n", stamp.string());
            continue;
        }
        if (!fs::exists(query))
            write_file_atomically(query, make_time_stamp_query(run_dir / signature.name));
        fmt::print(
            "query    {0}\n  send   curl -H 'Content-Type: application/timestamp-query' "
            "--data-binary '@{0}' -o reply.tsr AUTHORITY\n"
            "  then   runcert timestamp {1} --reply reply.tsr\n",
            query.string(), given);
        sent = true;
    }
    if (sent) fmt::print("AUTHORITY is the address of a time stamp authority (RFC 3161).\n");
    return 0;
}

/// The signature whose query a reply answers.
const SignatureFile& signature_asked_for(const fs::path& run_dir,
                                         const std::vector<SignatureFile>& signatures,
                                         const StampedHash& stamped, const std::string& reply) {
    for (const SignatureFile& signature : signatures) {
        const fs::path query = run_dir / time_stamp_query_name(signature.name);
        if (fs::exists(query) && read_time_stamp_query(query) == stamped) return signature;
    }
    throw Failure(reply, "the reply answers none of the queries in " + run_dir.string(),
                  "Give the reply to a query that runcert timestamp wrote there; a signature that "
                  "was made again needs a new one");
}

/// That the query was made for the signature as it is now.
void require_current(const fs::path& run_dir, const SignatureFile& signature,
                     const StampedHash& stamped, const std::string& reply) {
    const TemporaryFolder folder;
    const fs::path fresh = folder.path() / "query";
    write_file_atomically(fresh, make_time_stamp_query(run_dir / signature.name));
    const StampedHash now = read_time_stamp_query(fresh);
    if (now.algorithm != stamped.algorithm || now.imprint != stamped.imprint)
        throw Failure(reply, signature.name + " was changed after its query was made",
                      "Remove the query, and ask again for the signature as it is");
}

int take_reply(const fs::path& run_dir, const std::vector<SignatureFile>& signatures,
               const TimestampOptions& options) {
    const TimeStamp stamp = read_time_stamp_reply(options.reply);
    const SignatureFile& signature =
        signature_asked_for(run_dir, signatures, stamp.hash, options.reply);
    require_current(run_dir, signature, stamp.hash, options.reply);
    if (!options.cas.empty()) {
        const TimeStampCheck check =
            check_time_stamp(run_dir / signature.name, options.reply,
                             std::vector<fs::path>(options.cas.begin(), options.cas.end()));
        if (!check.valid)
            throw Failure(options.reply, "the time stamp does not hold: " + check.reason,
                          "Give the certificate of the root that this authority is under, or ask "
                          "another authority");
    }
    const fs::path file = run_dir / time_stamp_name(signature.name);
    write_file_atomically(file, read_handwritten(options.reply));
    fmt::print("stamp    {}\ntime     {}{}\n", file.string(), iso_text(stamp.time),
               options.cas.empty()
                   ? "  (as the reply states: whose it is was not checked, give --ca)"
                   : "");
    return 0;
}

/// Of a receipt, in the folder where it is.
int timestamp_receipt(const TimestampOptions& options) {
    const fs::path file = options.run_dir;
    (void)read_receipt(read_handwritten(file), file.string());
    const std::vector<SignatureFile> alone{{.name = file.filename().string()}};
    return options.reply.empty() ? write_queries(folder_of(file), alone, options.run_dir)
                                 : take_reply(folder_of(file), alone, options);
}

int timestamp(const TimestampOptions& options) {
    if (fs::is_regular_file(options.run_dir)) return timestamp_receipt(options);
    const fs::path run_dir = options.run_dir;
    const RunLock lock(run_dir);
    (void)read_report_facts(run_dir);
    const std::vector<SignatureFile> signatures = signature_files(run_dir);
    if (signatures.empty())
        throw Failure(run_dir.string(), "the report is not signed: there is nothing to stamp",
                      "Sign it first: runcert sign");
    return options.reply.empty() ? write_queries(run_dir, signatures, options.run_dir)
                                 : take_reply(run_dir, signatures, options);
}

}  // namespace

void add_timestamp(CLI::App& app, Command& chosen) {
    auto [line, options] = add_command<TimestampOptions>(
        app, chosen, "timestamp", "Have signatures time-stamped by an authority (RFC 3161)",
        timestamp);
    line.text("RUN_DIR", options.run_dir, "the folder of a signed run, or a receipt",
              CommandLine::required);
    line.text("--reply", options.reply, "what the authority answered to one of the queries");
    line.texts("--ca", options.cas,
               "certificate (PEM) of the root that the authority is under; may be repeated");
    line.need("--ca", "--reply");
    line.footer(
        "Without --reply: writes SIGNATURE.tsq for every signature that has no time stamp, and "
        "says how to send\nit. With it: finds the query that the reply answers, checks it and "
        "stores it as SIGNATURE.tsr.\nNothing is sent by this program. Whether a certificate was "
        "revoked is not looked at.\nExit status: 0 done, 2 it could not be done.");
}

}  // namespace runcert
