#include <fmt/format.h>

#include <algorithm>
#include <string_view>

#include "trust/bundle.h"

namespace runcert {
namespace {

std::vector<std::string> with_ending(const BundleFacts& facts, std::string_view begin,
                                     std::string_view end) {
    std::vector<std::string> some;
    for (const std::string& file : facts.files)
        if (file.starts_with(begin) && file.ends_with(end)) some.push_back(file);
    return some;
}

bool has(const BundleFacts& facts, std::string_view name) {
    return std::find(facts.files.begin(), facts.files.end(), name) != facts.files.end();
}

std::string opening(const BundleFacts& facts) {
    return fmt::format(
        "Bundle of the attempt \"{0}\"\n"
        "report {1}\n"
        "made by runcert {3}, source {4}{5}\n"
        "\n"
        "This is a complete measurement report with everything it was made from: the recordings "
        "as\n"
        "they were handed in (recording.*), the rules (profile.*), what each stage made of them "
        "(1-\n"
        "to 6-), the report (report.json; report.html, certificate.pdf and report.pdf are the same "
        "for reading), "
        "its\n"
        "signatures (report.json.*) and the keys that were given with it ({2}/).\n"
        "\n"
        "A key in this bundle proves nothing by itself: whoever makes a bundle can put any key "
        "in.\n"
        "Compare it with the one that its owner publishes elsewhere.\n"
        "\n"
        "Left out: run.yaml, the clock and durations of the computation, on which nothing "
        "depends.\n"
        "The bundle's files carry no times or owners of their own.\n"
        "\n",
        facts.attempt, facts.report_id, bundle_keys_folder, facts.program_version,
        facts.source_revision,
        facts.program_home.empty() ? "" : ",\nto be had at " + facts.program_home);
}

std::string unpacking(const BundleFacts& facts) {
    return fmt::format(
        "1. Unpack{1} and see that nothing was damaged on the way\n"
        "\n"
        "    {2} {0}{3}\n"
        "    cd {0}\n"
        "    sha256sum -c SHA256SUMS\n"
        "\n"
        "   This finds accidents. Whoever changes a file on purpose can change SHA256SUMS too: "
        "that\n"
        "   the report is genuine, only its signatures show.\n"
        "\n",
        facts.attempt, facts.form == ArchiveForm::zip ? "" : " (needs zstd)",
        facts.form == ArchiveForm::zip ? "unzip -q" : "tar --zstd -xf", ending_of(facts.form));
}

std::string minisign_lines(const BundleFacts& facts) {
    std::vector<std::string> keys = with_ending(facts, "keys/", ".pub");
    std::erase_if(keys, [](const std::string& key) {
        return key.starts_with(fmt::format("{}/{}", bundle_keys_folder, ssh_key_begin));
    });
    std::string text;
    for (const std::string& signature : with_ending(facts, "report.json", ".minisig")) {
        text += fmt::format("   {} (minisign):\n\n", signature);
        if (keys.empty())
            text += fmt::format("    minisign -V -m report.json -x {} -p KEY.pub\n", signature);
        for (const std::string& key : keys)
            text += fmt::format("    minisign -V -m report.json -x {} -p {}\n", signature, key);
        text += keys.size() > 1 ? "\n   One of them must hold.\n\n" : "\n";
    }
    return text;
}

std::string ssh_lines(const BundleFacts& facts) {
    std::string text;
    const std::string roster = has(facts, bundle_roster_file) ? bundle_roster_file : "ROSTER";
    for (const std::string& signature : with_ending(facts, "report.json", ".sig"))
        text += fmt::format(
            "   {0} (OpenSSH). Its role is what the first line prints before \"@runcert\":\n\n"
            "    sed '1d;$d' {0} | base64 -d | grep -a -o '[A-Za-z0-9_-]*@runcert'\n"
            "    ssh-keygen -Y verify -f {1} -I ROLE -n ROLE@runcert -s {0} < report.json\n\n",
            signature, roster);
    return text;
}

std::string stamp_lines(const BundleFacts& facts) {
    std::string text;
    const std::string root = has(facts, bundle_tsa_file) ? bundle_tsa_file : "AUTHORITY.pem";
    for (const std::string& stamp : with_ending(facts, "report.json", ".tsr"))
        text += fmt::format(
            "   {0} (RFC 3161; when {1} existed):\n\n"
            "    openssl ts -reply -in {0} -text\n"
            "    openssl ts -verify -data {1} -in {0} -CAfile {2}\n\n",
            stamp, stamp.substr(0, stamp.size() - 4), root);
    return text;
}

std::string signatures(const BundleFacts& facts) {
    const std::string lines = minisign_lines(facts) + ssh_lines(facts);
    std::string text = "2. Check who answers for report.json\n\n";
    text += lines.empty() ? "   The report is UNSIGNED: nobody answers for it.\n\n" : lines;
    text += stamp_lines(facts);
    if (!with_ending(facts, "attestations/answer-", ".json").empty())
        text +=
            "   attestations/ holds who answered for what the recording cannot show: DSSE "
            "envelopes "
            "of\n"
            "   in-toto statements about report.json. `runcert attest` with the folder alone lists "
            "them.\n\n";
    if (has(facts, "report.pdf"))
        text +=
            "   report.pdf may carry a seal of its own: `pdfsig -no-ocsp report.pdf` says so in "
            "words\n"
            "   (\"Signature is Valid\", \"Total document signed\"; its exit status says "
            "nothing).\n"
            "\n";
    return text;
}

std::string by_runcert(const BundleFacts& facts) {
    std::string options;
    // A roster says more than keys alone; verify takes one or the other.
    if (!has(facts, bundle_roster_file))
        for (const std::string& key : with_ending(facts, "keys/", ".pub"))
            options += fmt::format(" --pubkey {}/{}", facts.attempt, key);
    else
        options += fmt::format(" --roster {}/{}", facts.attempt, bundle_roster_file);
    if (has(facts, bundle_tsa_file))
        options += fmt::format(" --tsa-ca {}/{}", facts.attempt, bundle_tsa_file);
    return fmt::format(
        "3. Check that the report follows from the recordings (needs runcert)\n"
        "\n"
        "    cd ..\n"
        "    runcert verify {}{} --recompute\n"
        "\n"
        "   Every file against the report, each stage against the one before, the signatures; and "
        "with\n"
        "   --recompute, every stage is run again from the recordings and compared.\n"
        "   `runcert audit {}` says in plain words what was decided and why.\n"
        "   Keys in keys/ are the sender's word, and vouch for nobody: take the body's own roster, "
        "and\n"
        "   give it with --roster, to see whether the record counts as beaten.\n",
        facts.attempt, options, facts.attempt);
}

}  // namespace

std::string bundle_text(const BundleFacts& facts) {
    return opening(facts) + unpacking(facts) + signatures(facts) + by_runcert(facts);
}

}  // namespace runcert
