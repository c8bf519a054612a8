// SPDX-License-Identifier: Apache-2.0
// WebGL 2 in fewer words.

function shader(gl, kind, text) {
  const made = gl.createShader(kind);
  gl.shaderSource(made, '#version 300 es\nprecision highp float;\nprecision highp int;\n' +
    'precision highp sampler3D;\nprecision highp isampler3D;\n' + text);
  gl.compileShader(made);
  return made;
}

/// A program with `use(values)`: sets uniforms by name, whatever their type; textures take units by themselves.
export function makeProgram(gl, vertex, fragment) {
  const program = gl.createProgram();
  const shaders = [shader(gl, gl.VERTEX_SHADER, vertex), shader(gl, gl.FRAGMENT_SHADER, fragment)];
  for (const s of shaders) gl.attachShader(program, s);
  gl.linkProgram(program);
  if (!gl.getProgramParameter(program, gl.LINK_STATUS) && !gl.isContextLost())
    throw new Error([...shaders.map(s => gl.getShaderInfoLog(s)), gl.getProgramInfoLog(program)].join('\n'));
  const setters = new Map();
  let units = 0;
  gl.useProgram(program);
  for (let n = 0; n < gl.getProgramParameter(program, gl.ACTIVE_UNIFORMS); ++n) {
    const {name, type, size} = gl.getActiveUniform(program, n), at = gl.getUniformLocation(program, name);
    const plain = name.replace('[0]', '');
    const samplers = {[gl.SAMPLER_2D]: gl.TEXTURE_2D, [gl.SAMPLER_3D]: gl.TEXTURE_3D, [gl.INT_SAMPLER_3D]: gl.TEXTURE_3D};
    if (samplers[type]) {
      const unit = units++;
      gl.uniform1i(at, unit);
      setters.set(plain, texture => {
        gl.activeTexture(gl.TEXTURE0 + unit);
        gl.bindTexture(samplers[type], texture);
      });
      continue;
    }
    const set = {
      [gl.FLOAT]: v => size > 1 ? gl.uniform1fv(at, v) : gl.uniform1f(at, v),
      [gl.FLOAT_VEC2]: v => gl.uniform2fv(at, v), [gl.FLOAT_VEC3]: v => gl.uniform3fv(at, v),
      [gl.FLOAT_VEC4]: v => gl.uniform4fv(at, v), [gl.FLOAT_MAT4]: v => gl.uniformMatrix4fv(at, false, v),
      [gl.INT]: v => gl.uniform1i(at, v), [gl.INT_VEC3]: v => gl.uniform3iv(at, v), [gl.BOOL]: v => gl.uniform1i(at, v ? 1 : 0),
    }[type];
    setters.set(plain, set);
  }
  return {
    use(values) {
      gl.useProgram(program);
      for (const [name, set] of setters) {
        if (!(name in values)) throw new Error(`the shader's ${name} is not set`);
        set(values[name]);
      }
    },
  };
}

export function makeBuffer(gl, data, kind = gl.ARRAY_BUFFER) {
  const buffer = gl.createBuffer();
  gl.bindBuffer(kind, buffer);
  gl.bufferData(kind, data, gl.STATIC_DRAW);
  return buffer;
}

/// A vertex array of [location, buffer, size, type, normalized, stride, offset], and a buffer of indices.
export function makeArray(gl, attributes, indices = null) {
  const array = gl.createVertexArray();
  gl.bindVertexArray(array);
  for (const [location, buffer, size, type, normal = false, stride = 0, offset = 0] of attributes) {
    gl.bindBuffer(gl.ARRAY_BUFFER, buffer);
    gl.enableVertexAttribArray(location);
    gl.vertexAttribPointer(location, size, type, normal, stride, offset);
  }
  if (indices) gl.bindBuffer(gl.ELEMENT_ARRAY_BUFFER, indices);
  gl.bindVertexArray(null);
  return array;
}
