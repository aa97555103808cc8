# Close-up of one window. Needs `start`, `end` (s), `mean` and `target` (km/h, NaN for none).
pad = 0.5 * (end - start) > 1 ? 0.5 * (end - start) : 1
low = start - pad
high = end + pad
near(name) = column('time') >= low && column('time') <= high ? column(name) * 3.6 : NaN
stats trajectory using (near('speed')) name 'speed' nooutput
stats trajectory using (near('sigma_speed')) name 'sigma' nooutput
every = 1 + floor(speed_records / 1500)

curve = folder.'/window.dat'
set table curve
plot trajectory using (drawn(sprintf('%.3f %.4f %.4f %.4f %.4f %.4f', column('time'), \
    near('speed'), near('sigma_speed'), near('speed_v1'), near('speed_v2'), near('speed_kalman')), \
    column(0), every)) \
    with table if (in_arc(1) && keep && column('time') >= low && column('time') <= high)
unset table
set datafile separator whitespace
unset datafile columnheaders
set datafile missing 'nan'

bottom = speed_min - 2 * sigma_max
top = speed_max + 2 * sigma_max
do for [c = 4:5] {
    stats curve using c name 'method' nooutput
    bottom = method_records > 0 && method_min < bottom ? method_min : bottom
    top = method_records > 0 && method_max > top ? method_max : top
}
room = top > bottom ? top - bottom : 0.1
top = target > top && target < top + room ? target : top
bottom = target < bottom && target > bottom - room ? target : bottom
bottom = bottom - 0.05 * room
top = top + 0.05 * room
target_shown = target >= bottom && target <= top

set terminal svg size 760,350 font 'DejaVu Sans,13' name 'window' background 'white'
set output figure
set xlabel 'time from the first epoch (s)' offset 0, 0.5
set ylabel 'horizontal speed (km/h)'
set xrange [low:high]
set yrange [bottom:top]
set object 1 rect from start, graph 0 to end, graph 1 behind fillcolor rgb sky \
    fillstyle solid 0.22 noborder
if (mean == mean) {
    set arrow 1 from start, mean to end, mean nohead front linewidth 2.2 linecolor rgb black
}
plot curve using 1:($2 - 2 * $3):($2 + 2 * $3) with filledcurves fillstyle solid 0.30 noborder \
        linecolor rgb blue title 'smoothed, ± 2 σ', \
    curve using 1:4 with points pointtype 1 pointsize 0.6 linewidth 1.2 linecolor rgb green \
        title 'method v1', \
    curve using 1:5 with points pointtype 7 pointsize 0.45 linecolor rgb vermilion \
        title 'method v2', \
    curve using 1:6 with lines dashtype 4 linewidth 1.6 linecolor rgb purple \
        title 'forward filter of [DHD22]', \
    curve using 1:2 with lines linewidth 1.8 linecolor rgb blue title 'smoothed', \
    for [i = 1:target_shown] target with lines dashtype 2 linewidth 1.4 linecolor rgb vermilion \
        title 'speed to reach', \
    NaN with lines linewidth 2.2 linecolor rgb black \
        title mean == mean ? 'speed that counts' : ''
