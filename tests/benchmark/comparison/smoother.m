% Kalman filter and RTS smoother of nine states in Octave.
%   octave-cli smoother.m DATA RESULT EVERY
% DATA and RESULT as comparison_data.h says. Prints its times as one line of JSON.
% The measurement sees the first three states alone, so that its products are blocks of the
% covariance.
1;

function model = make_model(dt)
  f = [1, dt, dt^2/2; 0, 1, dt; 0, 0, 1];
  q = [dt^5/20, dt^4/8, dt^3/6; dt^4/8, dt^3/3, dt^2/2; dt^3/6, dt^2/2, dt];
  model.f = kron(f, eye(3));
  model.q = kron(q, eye(3));
end

function [xp, pp, xf, pf] = forward(model, z, r)
  epochs = columns(z);
  xp = xf = zeros(9, epochs);
  pp = pf = zeros(9, 9, epochs);
  f = model.f;
  ft = f';
  q = model.q;
  x = [z(:, 1); zeros(6, 1)];
  p = diag([1e4, 1e4, 1e4, 9e4, 9e4, 9e4, 1e4, 1e4, 1e4]);
  for k = 1:epochs
    if k > 1
      x = f * x;
      p = f * p * ft + q;
    end
    xp(:, k) = x;
    pp(:, :, k) = p;
    ph = p(:, 1:3);
    gain = ph / (p(1:3, 1:3) + r(:, :, k));
    x += gain * (z(:, k) - x(1:3));
    p -= gain * ph';
    p = (p + p') / 2;
    xf(:, k) = x;
    pf(:, :, k) = p;
  end
end

function [xs, ps] = backward(model, xp, pp, xf, pf)
  ft = model.f';
  xs = zeros(size(xf));
  ps = zeros(size(pf));
  xs(:, end) = x = xf(:, end);
  ps(:, :, end) = p = pf(:, :, end);
  for k = columns(xf)-1:-1:1
    pk = pf(:, :, k);
    ahead = pp(:, :, k + 1);
    gain = pk * ft / ahead;
    x = xf(:, k) + gain * (x - xp(:, k + 1));
    p = pk + gain * (p - ahead) * gain';
    xs(:, k) = x;
    ps(:, :, k) = p;
  end
end

function write_points(name, x, p, every)
  at = 1:every:columns(x);
  sigma = zeros(6, numel(at));
  for i = 1:6
    sigma(i, :) = sqrt(squeeze(p(i, i, at)));
  end
  file = fopen(name, "w");
  fwrite(file, [x(1:6, at); sigma], "double");
  fclose(file);
end

arguments = argv();
file = fopen(arguments{1});
data = fread(file, [9, Inf], "double=>double");
fclose(file);
z = data(1:3, :);
r = reshape(data([4 5 6 5 7 8 6 8 9], :), 3, 3, []);
clear data;
model = make_model(0.05);
clock_id = tic;
[xp, pp, xf, pf] = forward(model, z, r);
filter_seconds = toc(clock_id);
[xs, ps] = backward(model, xp, pp, xf, pf);
seconds = toc(clock_id);
write_points(arguments{2}, xs, ps, str2double(arguments{3}));
printf("{\"epochs\": %d, \"seconds\": %.9f, \"filter_seconds\": %.9f}\n", columns(z), seconds, ...
       filter_seconds);
