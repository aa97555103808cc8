# The track in the plane, both axes in the same scale. Needs `every`, `georeferenced`; `windows`
# with their beginnings and ends (s).
stats trajectory using (column('east')) name 'east' nooutput
stats trajectory using (column('north')) name 'north' nooutput
curve = folder.'/track.dat'
started = 0
visit(e, n) = (started || !(e == e) ? 0 : (first_east = e, first_north = n, started = 1), \
    e == e ? (last_east = e, last_north = n) : 0, sprintf('%.3f %.3f', e, n))
set table curve
plot trajectory using (drawn(visit(column('east'), column('north')), column(0), every)) \
    with table if (in_arc(1) && keep)
unset table
highlight = folder.'/highlight.dat'
inside(t) = sum [i = 1:windows] (t >= window_start[i] - 1e-6 && t <= window_end[i] + 1e-6)
set table highlight
plot trajectory using (sprintf('%.3f %.3f', column('east'), column('north'))) \
    with table if (in_arc(1) && inside(column('time')) > 0)
unset table
set datafile separator whitespace
unset datafile columnheaders

# The canvas follows the track's shape, between a band and a square.
width = east_max - east_min
height = north_max - north_min
large = (width > height ? width : height) > 1 ? (width > height ? width : height) : 1
half_width = 0.55 * (width > 0.9 * large ? width : 0.9 * large)
half_height = 0.55 * (height > 0.35 * large ? height : 0.35 * large)
middle_east = 0.5 * (east_min + east_max)
middle_north = 0.5 * (north_min + north_max)
plot_width = 660.0
canvas_height = int(plot_width * half_height / half_width) + 90
set terminal svg size 760, canvas_height > 520 ? 520 : canvas_height font 'DejaVu Sans,13' \
    name 'track' background 'white'
set output figure
set size ratio -1
# Six ticks at most along the longer axis: a step of 1, 2 or 5 times a power of ten.
raw = 2 * (half_width > half_height ? half_width : half_height) / 6
power = 10 ** floor(log10(raw))
step = raw <= 2 * power ? 2 * power : raw <= 5 * power ? 5 * power : 10 * power
set xtics step
set ytics step
set xlabel georeferenced ? 'east of the origin (m)' : 'first plane coordinate (m)'
set ylabel georeferenced ? 'north of the origin (m)' : 'second plane coordinate (m)'
set xrange [middle_east - half_width : middle_east + half_width]
set yrange [middle_north - half_height : middle_north + half_height]
set rmargin 10
set arrow 1 from screen 0.95, screen 0.80 to screen 0.95, screen 0.93 \
    head filled size screen 0.012, 20 front linewidth 1.6 linecolor rgb black
set label 1 (georeferenced ? 'N' : 'plane N') at screen 0.95, screen 0.76 center front
set label 2 'start   ' at first_east, first_north right front \
    point pointtype 6 pointsize 1.1 linewidth 1.8 linecolor rgb green
set label 3 '   end' at last_east, last_north left front \
    point pointtype 4 pointsize 1.1 linewidth 1.8 linecolor rgb black
plot curve using 1:2 with lines linewidth 1.6 linecolor rgb blue title 'track', \
    for [i = 1:windows > 0] highlight using 1:2 with points pointtype 7 pointsize 0.45 \
        linecolor rgb vermilion title 'certified window'
