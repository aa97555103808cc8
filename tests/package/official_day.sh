#!/bin/bash
# An official's day with the installed program, nothing else at hand: an attempt is certified, signed
# and answered for until its record is beaten; a board takes the bundle and verifies it.
set -euo pipefail
cd "$(mktemp -d)"
says() { # says FILE TEXT
    grep -qF -- "$2" "$1" || { cat "$1"; echo "not said: $2"; exit 1; }
}
cp -r /usr/share/doc/runcert/examples .
for role in measurer judge board; do
    runcert keygen --no-password --out "$role" --role "$role" | sed -n 's/^roster *//p' >>roster
done

# A recording of one's own, with nothing else at hand.
mkdir own
cp examples/salt_lake/recording.pos own/run.pos
runcert new own/run.pos --craft yacht --class land-yacht --rule nalsa --official measurer \
    --record "202.9 km/h" --source "as published" </dev/null >said
runcert certify own/attempt.yaml --out own/run --quiet >said || [[ $? == 1 ]]
says said "nalsa: "

begun=$(date +%s%N)
runcert certify examples/land_yacht/attempt.yaml --out run --key measurer.key >said
echo "first answer: $((($(date +%s%N) - begun) / 1000000)) ms"
says said "14 answers are due"

answer() { runcert attest run --yes --no-render "$@" >>said; }
answer accuracy positions-on-the-earth time-scale kind-of-solution recording-as-read \
    --role measurer --key measurer.key
answer secondary-method flat-course wind-power-only observers positions-as-measured \
    craft-and-attempts date-of-the-recording --role judge --key judge.key
answer margin measurement-plan --role board --key board.key
answer --recomputed --role board --key board.key
runcert attest run --close --role board --key board.key --yes --roster roster >>said
mkdir board
for form in "" --zip; do
    runcert bundle run --roster roster $form --out "board/run$form" >>said
    echo "bundle $form: $(stat -c %s "board/run$form") bytes"
done
cp roster board
cd board
for bundle in run*; do
    runcert verify "$bundle" --roster roster --recompute >said
    says said "nalsa: Record beaten, by the roster "
    says said ": compare it with your body's. Standing: complete."
    grep -qx "VERIFIED" said || { cat said; exit 1; }
done

# A changed file is found, whoever sends it.
cp -r ../run forged
printf "x" >>forged/4-trajectory.ecsv
if runcert verify forged --roster roster >said; then cat said; exit 1; fi
grep -q "^NOT VERIFIED: 4-trajectory.ecsv" said || { tail -3 said; exit 1; }
