# What all figures share. Colours are those of Okabe and Ito, told apart by the colour-blind.
# Called with the trajectory, the screened table, the figure to write and a folder for tables.
trajectory = ARG1
screened = ARG2
figure = ARG3
folder = ARG4
black = '#000000'
blue = '#0072B2'
vermilion = '#D55E00'
orange = '#E69F00'
green = '#009E73'
purple = '#CC79A7'
sky = '#56B4E9'
grey = '#666666'

set encoding utf8
set decimalsign '.'
set border 3 linewidth 0.8 linecolor rgb grey
set tics nomirror out scale 0.5
set grid linewidth 0.6 linecolor rgb '#dddddd'
set key noenhanced outside below horizontal left reverse Left samplen 2.5 spacing 1.15 width -5
set datafile separator ','
set datafile columnheaders

# One line of a table, after an empty one where a new arc begins, so that lines break there.
# Every row of which this is asked either begins an arc or counts towards the thinning.
previous_arc = -1
keep = 0
drawn(text, row, every) = (begins = column('arc') != previous_arc, previous_arc = column('arc'), \
    keep = begins || int(row) % every == 0, (begins ? "\n" : '').text)
in_arc(any) = strlen(stringcolumn('arc')) > 0
