# Horizontal speed over the whole run. Needs `every`, `unusable`; `windows`, `refused_windows` with
# their beginnings and ends (s); `targets` (km/h) with their titles.
stats trajectory using (column('speed') * 3.6) name 'speed' nooutput
stats screened using (column('time')) name 'time' nooutput
top = speed_max
do for [i = 1:targets] { top = target[i] > top ? target[i] : top }
top = top > 0 ? 1.08 * top : 1
span = time_max > time_min ? time_max - time_min : 1
bins = 400
bin(t) = floor((t - time_min) / span * bins)

curve = folder.'/speed.dat'
set table curve
plot trajectory using (drawn(sprintf('%.3f %.3f', column('time'), column('speed') * 3.6), \
    column(0), every)) with table if (in_arc(1) && keep)
unset table

last_bin = -1
unused = folder.'/unused.dat'
set table unused
plot screened using (sprintf('%.3f', time_min + span * (bin(column('time')) + 0.5) / bins)) \
    with table if (stringcolumn('usable') eq 'False' && bin(column('time')) != last_bin \
        && (last_bin = bin(column('time')), 1))
unset table
set datafile separator whitespace
unset datafile columnheaders

set terminal svg size 760,330 font 'DejaVu Sans,13' name 'speed' background 'white'
set output figure
set xlabel 'time from the first epoch (s)' offset 0, 0.5
set ylabel 'horizontal speed (km/h)'
set xrange [time_min : time_min + span]
set yrange [-0.06 * top : top]
do for [i = 1:refused_windows] {
    set object 100 + i rect from refused_window_start[i], graph 0 \
        to refused_window_end[i], graph 1 behind \
        fillcolor rgb orange fillstyle solid 0.30 noborder
}
do for [i = 1:windows] {
    set object i rect from window_start[i], graph 0 to window_end[i], graph 1 behind \
        fillcolor rgb sky fillstyle solid 0.45 noborder
}
plot for [i = 1:windows > 0] NaN with boxes fillstyle solid 0.45 noborder \
        linecolor rgb sky title 'certified window', \
    for [i = 1:refused_windows > 0] NaN with boxes fillstyle solid 0.30 noborder \
        linecolor rgb orange title 'refused window', \
    for [i = 1:targets] target[i] with lines dashtype 1 + i linewidth 1.4 \
        linecolor rgb vermilion title target_title[i], \
    for [i = 1:unusable > 0] unused using 1:(-0.03 * top):(0.5 * span / bins):(0.015 * top) \
        with boxxyerror fillstyle solid 1.0 noborder linecolor rgb black \
        title 'epochs not used', \
    curve using 1:2 with lines linewidth 1.6 linecolor rgb blue title 'smoothed speed'
