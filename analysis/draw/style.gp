# style.gp - what the pictures share: colours, sizes, texts, tics. Loaded once, before the picture and
# its data; what it defines are variables and functions, some of which give a command to `eval`. What
# functions change has names that begin with f_.
set encoding utf8

# ---- colours: after Okabe and Ito (2008), so that readers who do not tell red from green tell these
# apart; blue hues stand for standing, orange for falling ----
colour_stabilised = 0x0072b2
colour_rested = 0x56b4e9
colour_fell = 0xe69f00
colour_undecided = 0xcc79a7
colour_done = 0x009e73
colour_failed = 0x000000
colour_pending = 0xe4e4e4
# Of curves side by side.
array hue[7] = [0x0072b2, 0xd55e00, 0x009e73, 0xcc79a7, 0xe69f00, 0x56b4e9, 0x000000]
grey = 0x8a8a8a
no_number = 0xd9d9d9

# Numbers: after cividis (Nunez, Anderton, Renslow 2018), even steps for every reader.
palette = "set palette defined (0 '#00224e', 0.25 '#434e6c', 0.5 '#7d7c78', 0.75 '#bcae6c', 1 '#fee838')"
grid = "set grid lt 1 lc rgb '#e6e6e6' lw 0.8"

# ---- the canvas: page_width x page_height px, from its upper left corner ----
margin = 18.0
X(px) = 1.0*px/page_width
Y(px) = 1 - 1.0*px/page_height
panel(left, top, width, height) = sprintf( \
    "set lmargin at screen %.6f; set rmargin at screen %.6f; set tmargin at screen %.6f; set bmargin at screen %.6f", \
    X(left), X(left + width), Y(top), Y(top + height))
colour_bar(left, top, width, height) = sprintf( \
    "set colorbox %s user origin screen %.6f, screen %.6f size screen %.6f, screen %.6f", \
    width > height ? 'horizontal' : 'vertical', X(left), Y(top + height), X(width), 1 - Y(height))

# ---- texts; DejaVu Sans takes 0.69 of its size per letter on the average ----
title_size = 15
text_size = 12
small = "font ',11'"
tiny = "font ',10'"
letters(px, size) = int(px/(0.69*size))
# Up to n letters a line, broken at blanks; a word that is longer has a line of its own.
blank(s, i) = i < 1 || s[i:i] eq ' ' ? i : blank(s, i - 1)
wrap(s, n) = strlen(s) <= n ? s : (f_at = blank(s, n + 1), f_at = f_at < 1 ? strstrt(s, ' ') : f_at, \
    f_at < 1 ? s : s[1:f_at-1]."\n".wrap(s[f_at+1:*], n))
lines(s) = (f_at = strstrt(s, "\n"), f_at < 1 ? 1 : 1 + lines(s[f_at+1:*]))
lines_height(s, size) = lines(s)*(int(size*1.25) + 3)
cut(s, n) = strlen(s) <= n || n < 4 ? s : s[1:n-3].'...'
with_unit(name, unit) = unit eq '' ? name : name.' ('.unit.')'
# What the title and the line under it take of a page that is page_width wide.
title_text(s, size) = wrap(s, letters(page_width - 2*margin, size))
title_height(_) = margin + lines_height(title_text(title, title_size), title_size) \
    + lines_height(title_text(subtitle, text_size), text_size) + 10
# Long name and path of an axis, in `px` pixels each.
axis_label(a, px) = (value(a.'_text') eq '' ? '' : cut(value(a.'_text'), int(px/6.9))."\n") \
    .cut(value(a.'_path'), int(px/6.9))

# ---- legends: filled boxes with texts, and notes under them; the data add theirs ----
array legend_text[40]
array legend_colour[40]
array note[12]
legends = 0
notes = 0
legend_step = 24
legend_head = ''
box(left, y, colour) = sprintf("set object rectangle from screen %.6f,%.6f to screen %.6f,%.6f fillcolor rgb %d " \
    ."fillstyle solid border lc '#606060' lw 0.5 front", X(left), Y(y + 7), X(left + 14), Y(y - 7), colour)

# ---- tics of the axis whose name begins with x or y: at most about n ----
round_up(x) = (f_power = 10.0**floor(log10(x)), f_digit = x/f_power*(1 - 1e-9), \
    (f_digit <= 1 ? 1 : f_digit <= 2 ? 2 : f_digit <= 5 ? 5 : 10)*f_power)
round_step(low, high, n) = high > low ? round_up(1.0*(high - low)/(n > 1 ? n : 1)) : 1.0
tic(text, place) = sprintf(", '%s' %.17g", text, place)
range(a, low, high) = sprintf("set %srange [%.17g:%.17g]; set %stics ", a[1:1], low, high, a[1:1])
linear_tics(a, low, high, n, labelled) = range(a, low, high).sprintf("%.10g; set format %s '%s'", \
    round_step(low, high, n), a[1:1], labelled ? '%.10g' : '')
panel_tics(low, high, height) = linear_tics('y', low, high, height < 160 ? 4 : int(height/36), 1)
# Places are decimal logarithms, low and high too; on an axis that is logarithmic itself they are not.
# Less than a decade has round steps, more the mantissas for which there is room.
log_place(real, power) = real ? 10**power : power
round_tics(low, high, n, labelled, real) = (f_tics = '', f_step = round_step(10**low, 10**high, n), \
    sum [f_i=int(ceil(10**low/f_step - 1e-9)):int(floor(10**high/f_step + 1e-9))] (f_tics = f_tics \
        .tic(labelled ? sprintf('%g', f_i*f_step) : '', log_place(real, log10(f_i*f_step))), 0), f_tics[3:*])
digit_tics(low, high, n, labelled, real) = (f_tics = '', f_every = int(ceil((high - low)/n)), \
    f_digits = n >= 3*(high - low) ? '1 2 5' : n >= 2*(high - low) ? '1 3' : '1', \
    sum [f_i=int(floor(low)):int(ceil(high))] sum [f_k=1:words(f_digits)] (f_place = f_i + log10(word(f_digits, f_k) + 0), \
        f_place > low - 1e-9 && f_place < high + 1e-9 && f_i % f_every == 0 ? (f_tics = f_tics \
            .tic(labelled ? sprintf('%g', 10**f_place) : '', log_place(real, f_place)), 0) : 0), f_tics[3:*])
log_tics(a, low, high, n, labelled, real) = range(a, log_place(real, low), log_place(real, high)).'(' \
    .(high - low < 0.8 ? round_tics(low, high, n, labelled, real) : digit_tics(low, high, n, labelled, real)).')'
# Words, and numbers without an even spacing: every so-manieth of those that the data name.
list_tics(a, low, high, n, labelled) = value(a.'_words') < 1 ? range(a, low, high).'()' : (f_tics = '', f_every = (value(a.'_words') + int(n) - 1)/int(n), \
    sum [f_i=0:(value(a.'_words') - 1)/f_every] (f_tics = f_tics.sprintf(', %s %s_at[%d]', \
        labelled ? sprintf('%s_word[%d]', a, f_i*f_every + 1) : "''", a, f_i*f_every + 1), 0), range(a, low, high).'('.f_tics[3:*].')')
# Range and tics of the axis that the data describe.
axis_tics(a, n, labelled) = value(a.'_scale') eq 'linear' ? linear_tics(a, value(a.'_low'), value(a.'_high'), n, labelled) \
    : value(a.'_scale') eq 'log' ? log_tics(a, value(a.'_low'), value(a.'_high'), n, labelled, 0) \
    : list_tics(a, value(a.'_low'), value(a.'_high'), n, labelled)

# ---- maps: the cells of panel p over the axes x and y, see plot_cells_write ----
cells_of(a) = (f_half = value(a.'_count') == 1 ? 2 : 1, sprintf('%s_cells = %d; %s_size = %.17g; %s_first = %.17g', \
    a, value(a.'_count')*f_half, a, value(a.'_step')/f_half, a, value(a.'_low') + 0.5*value(a.'_step')/f_half))
cells = "sprintf('cells%d', p) binary array=(x_cells,y_cells) dx=x_size dy=y_size origin=(x_first,y_first)"
as_colours = "format='%uchar' using (cell_colour($1)>>16):(cell_colour($1)>>8&255):(cell_colour($1)&255) with rgbimage"
as_numbers = "format='%float64' using 1 with image"
